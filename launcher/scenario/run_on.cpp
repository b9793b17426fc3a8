// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/run_on.hpp"

#include "common/text.hpp"
#include "launcher/scenario/scenario.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

constexpr std::array<std::pair<std::string_view, RunOn::Kind>, 3> kWords{{{"native", RunOn::Kind::native},
                                                                          {"qemu-user", RunOn::Kind::qemu_user},
                                                                          {"qemu-system", RunOn::Kind::qemu_system}}};

/// Emulated code takes 5 to 20 times as long, and a process starts in a second or two.
constexpr double kEmulationPatience = 4;

/// A board takes the place of the host: nobody else can be on it, and our programs alone are in its image.
void check_board(Scenario const& scenario, Process const& process, config::SourceMark const& where,
                 config::Diagnostics& diagnostics) {
    auto const length = static_cast<int>(process.run_on.size());
    if (process.program.name == "exec") {
        diagnostics.error(
            where,
            fmt::format("process '{}' is a program of your own, which is not in the board's image", process.name.name),
            "`run_on: qemu-user`", length);
    }
    for (Process const& other : scenario.processes) {
        if (&other != &process && other.host.name == process.host.name) {
            diagnostics.error(where,
                              fmt::format("process '{}' is a board of its own, and '{}' runs on the same host '{}'",
                                          process.name.name, other.name.name, process.host.name),
                              "give it a host of its own", length);
            return;
        }
    }
}

} // namespace

std::optional<RunOn> parse_run_on(std::string_view text) {
    for (auto const& [word, kind] : kWords) {
        if (text == word) {
            return RunOn{kind};
        }
    }
    return std::nullopt;
}

double patience(Scenario const& scenario) {
    return std::any_of(scenario.processes.begin(), scenario.processes.end(),
                       [](Process const& p) { return parse_run_on(p.run_on).value_or(RunOn{}).is_emulated(); })
               ? kEmulationPatience
               : 1;
}

void check_run_on(Scenario const& scenario, config::Diagnostics& diagnostics) {
    for (Process const& process : scenario.processes) {
        config::Node const* node = process.node.find("run_on");
        auto const where = node == nullptr ? process.name.where : node->where;
        auto const run_on = parse_run_on(process.run_on);
        if (!run_on) {
            std::vector<std::string> words;
            for (auto const& [word, kind] : kWords) {
                words.emplace_back(word);
            }
            auto const near = nearest_spelling(process.run_on, words);
            diagnostics.error(
                where, fmt::format("process '{}' runs on '{}', which is no place", process.name.name, process.run_on),
                near ? fmt::format("did you mean '{}'?", *near) : fmt::format("there are: {}", join(words, ", ")),
                static_cast<int>(process.run_on.size()));
        } else if (run_on->is_emulated() &&
                   (process.program.name == "gridspace-sim" || process.program.name == "gridspace-monitor")) {
            diagnostics.error(
                where,
                fmt::format("process '{}' runs on '{}', but {} stays on the machine that runs the scenario",
                            process.name.name, process.run_on, process.program.name),
                "`run_on: native`", static_cast<int>(process.run_on.size()));
        } else if (run_on->kind == RunOn::Kind::qemu_system) {
            check_board(scenario, process, where, diagnostics);
        }
    }
}

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/run_on.hpp"

#include "common/text.hpp"
#include "launcher/scenario/scenario.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

constexpr std::array<std::pair<std::string_view, RunOn::Kind>, 4> kWords{{{"native", RunOn::Kind::native},
                                                                          {"qemu-user", RunOn::Kind::qemu_user},
                                                                          {"qemu-system", RunOn::Kind::qemu_system},
                                                                          {"external", RunOn::Kind::external}}};
constexpr std::string_view kSsh = "ssh:";

/// Nothing that ssh or a shell could take for something else.
bool is_plain_name(std::string_view text) {
    return !text.empty() && text.front() != '-' && std::all_of(text.begin(), text.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '.' || c == '_' || c == '-';
    });
}

/// "user@host:port": user and port may be missing, an IPv6 address stands in brackets.
std::optional<RunOn> parse_ssh(std::string_view text) {
    RunOn out;
    out.kind = RunOn::Kind::ssh;
    if (std::size_t const at = text.find('@'); at != std::string_view::npos) {
        out.user = text.substr(0, at);
        text.remove_prefix(at + 1);
        if (!is_plain_name(out.user)) {
            return std::nullopt;
        }
    }
    bool const is_v6 = text.starts_with('[');
    std::size_t const end = is_v6 ? text.find(']') : std::min(text.find(':'), text.size());
    if (end == std::string_view::npos) {
        return std::nullopt;
    }
    out.host = text.substr(is_v6 ? 1 : 0, is_v6 ? end - 1 : end);
    bool const v6_fits =
        is_v6 && !out.host.empty() && out.host.find_first_not_of("0123456789abcdefABCDEF:.") == std::string::npos;
    text.remove_prefix(is_v6 ? end + 1 : end);
    if (!text.empty()) {
        if (text.front() != ':') {
            return std::nullopt;
        }
        text.remove_prefix(1);
        auto const [last, error] = std::from_chars(text.data(), text.data() + text.size(), out.port);
        if (error != std::errc{} || last != text.data() + text.size() || out.port < 1 || out.port > 65535) {
            return std::nullopt;
        }
    }
    return is_v6 ? (v6_fits ? std::optional{out} : std::nullopt)
                 : (is_plain_name(out.host) ? std::optional{out} : std::nullopt);
}

/// Emulated code takes 5 to 20 times as long, and a process starts in a second or two.
constexpr double kEmulationPatience = 4;

/// The timeline acts on what the launcher has started.
void check_events(Scenario const& scenario, config::Diagnostics& diagnostics) {
    for (sim::Event const& event : process_events(scenario)) {
        for (Ref const* target : {&event.kill, &event.pause, &event.resume, &event.restart}) {
            Process const* process = target->empty() ? nullptr : scenario.find_process(target->name);
            if (process != nullptr && is_external(*process)) {
                diagnostics.error(
                    target->where,
                    fmt::format("event '{}' acts on '{}', which somebody else has started (`run_on: external`)",
                                event.name.name, target->name),
                    "another `run_on`, or no such event", static_cast<int>(target->name.size()));
            }
        }
    }
}

/// Real interfaces take the place of a host's cables only where somebody else runs the host.
void check_plugs(Scenario const& scenario, config::Diagnostics& diagnostics) {
    for (Host const& host : scenario.hosts) {
        for (auto const& [link, interface] : host.plugs) {
            auto const width = static_cast<int>(link.name.size());
            if (link.name != "mgmt0" && std::find(host.links.begin(), host.links.end(), link) == host.links.end()) {
                std::vector<std::string> names{"mgmt0"};
                for (Ref const& own : host.links) {
                    names.push_back(own.name);
                }
                diagnostics.error(link.where, fmt::format("host '{}' is not on a link '{}'", host.name.name, link.name),
                                  fmt::format("it is on: {}", join(names, ", ")), width);
            }
            for (Process const& process : scenario.processes) {
                if (process.host == host.name && !is_external(process)) {
                    diagnostics.error(
                        link.where,
                        fmt::format(
                            "a real interface is plugged in the place of host '{}', on which '{}' is to be started",
                            host.name.name, process.name.name),
                        "`run_on: external` for it", width);
                }
            }
        }
    }
}

/// A board takes the place of the host: nobody else can be on it, and our programs alone are in its image.
void check_board(Scenario const& scenario, Process const& process, config::SourceMark const& where,
                 config::Diagnostics& diagnostics) {
    auto const length = static_cast<int>(process.run_on.size());
    if (process.is_foreign()) {
        diagnostics.error(
            where,
            fmt::format("process '{}' is a program of your own, and a board is given ours alone", process.name.name),
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

std::string RunOn::place() const {
    bool const is_v6 = host.find(':') != std::string::npos;
    return fmt::format("{}{}{}{}{}", user, user.empty() ? "" : "@", is_v6 ? "[" : "", host, is_v6 ? "]" : "") +
           (port > 0 ? fmt::format(":{}", port) : "");
}

void describe(config::Fields& f, SshSettings& ssh) {
    f.file("identity", ssh.identity, {.doc = "private key; without it ssh's own configuration says which"});
    f.file("config", ssh.config, {.doc = "configuration of ssh, instead of ~/.ssh/config"});
    f.text("installed", ssh.installed,
           {.doc = "folder of an installed bundle on the board, for example /opt/gridspace-relay2; without it the "
                   "program is copied there"});
}

std::optional<RunOn> parse_run_on(std::string_view text) {
    if (text.starts_with(kSsh)) {
        return parse_ssh(text.substr(kSsh.size()));
    }
    for (auto const& [word, kind] : kWords) {
        if (text == word) {
            RunOn out;
            out.kind = kind;
            return out;
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
    check_events(scenario, diagnostics);
    check_plugs(scenario, diagnostics);
    for (Process const& process : scenario.processes) {
        config::Node const* node = process.node.find("run_on");
        auto const where = node == nullptr ? process.name.where : node->where;
        auto const run_on = parse_run_on(process.run_on);
        if (!run_on) {
            if (process.run_on.starts_with("ssh")) {
                diagnostics.error(
                    where,
                    fmt::format("process '{}' runs on '{}', which names no machine", process.name.name, process.run_on),
                    "ssh:HOST or ssh:USER@HOST:PORT, for example ssh:root@192.168.7.2; HOST may be a name of "
                    "~/.ssh/config",
                    static_cast<int>(process.run_on.size()));
                continue;
            }
            std::vector<std::string> words;
            for (auto const& [word, kind] : kWords) {
                words.emplace_back(word);
            }
            words.emplace_back("ssh:HOST");
            diagnostics.error(
                where, fmt::format("process '{}' runs on '{}', which is no place", process.name.name, process.run_on),
                spelling_hint(process.run_on, words), static_cast<int>(process.run_on.size()));
        } else if (run_on->kind != RunOn::Kind::native &&
                   (process.program.name == "gridspace-sim" || process.program.name == "gridspace-monitor")) {
            diagnostics.error(
                where,
                fmt::format("process '{}' runs on '{}', but {} stays on the machine that runs the scenario",
                            process.name.name, process.run_on, process.program.name),
                "`run_on: native`", static_cast<int>(process.run_on.size()));
        } else if (run_on->kind == RunOn::Kind::qemu_user && process.settings != nullptr &&
                   !process.settings->bumps(scenario, process).empty()) {
            diagnostics.warning(where,
                                fmt::format("process '{}' sits in a cable: frames that it hands on lose their VLAN tag",
                                            process.name.name),
                                "qemu-user does not pass on the tags of received frames; run_on: native keeps them",
                                static_cast<int>(process.run_on.size()));
        } else if (run_on->kind == RunOn::Kind::qemu_system || run_on->kind == RunOn::Kind::ssh) {
            check_board(scenario, process, where, diagnostics);
        }
    }
}

bool is_external(Process const& process) {
    return parse_run_on(process.run_on).value_or(RunOn{}).kind == RunOn::Kind::external;
}

} // namespace gridspace::launcher

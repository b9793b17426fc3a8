// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/controls/controls.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim {
namespace {

/// Who sends ever other names fills no memory: beyond so many, refusals are only counted.
constexpr std::size_t kMaxSaid = 1000;

std::string number(double value) {
    return std::isnan(value) ? "nan" : shortest(value);
}

std::vector<std::string> names_of(std::vector<Ref> const& refs) {
    std::vector<std::string> out;
    for (Ref const& ref : refs) {
        out.push_back(ref.name);
    }
    return out;
}

} // namespace

Controls::Controls(std::vector<ControlConfig> const& configs, Network const& network, bool waveform,
                   Control::Grid const& grid)
    : grid_{grid} {
    for (ActionKind const& kind : action_kinds()) {
        for (std::string const& name : kind.names(network)) {
            elements_.insert(fmt::format("{}.{}", kind.prefix, name));
        }
    }
    for (ControlConfig const& c : configs) {
        auto const* q = c.quantity.empty() ? nullptr : c.kind->quantity(c.quantity, waveform);
        for (std::string const& element : elements_of(c, configs, network, waveform)) {
            std::string const name = fmt::format("{}.{}", c.kind->prefix, element);
            if (q != nullptr) {
                Control::Limits limits{range_of(network, *c.kind, element, *q, waveform), c.ramp_per_s, c.hold_s,
                                       c.then.value_or(0)};
                limits.allowed.min = std::max(limits.allowed.min, c.low.value_or(-INFINITY));
                limits.allowed.max = std::min(limits.allowed.max, c.high.value_or(INFINITY));
                std::string const path = fmt::format("{}.{}.{}", c.kind->section, element, c.quantity);
                std::string const full = fmt::format("{}.{}", name, c.quantity);
                quantities_.emplace(
                    full, Steered{Control{path, full, limits, grid, start_value(network, *c.kind, element, *q)},
                                  names_of(c.from)});
                continue;
            }
            Commands commands{names_of(c.from), {}, mode_words(*c.kind)};
            for (CommandUse const& use : c.kind->commands) {
                std::string_view const word = kCommands[static_cast<std::size_t>(use.command)];
                bool const named = c.commands.empty() || std::any_of(c.commands.begin(), c.commands.end(),
                                                                     [&](Ref const& r) { return r.name == word; });
                if (named && (waveform ? use.in_waveforms : use.in_phasors)) {
                    commands.allowed.insert(use.command);
                }
            }
            commands_.emplace(name, std::move(commands));
        }
    }
}

Controls::Why Controls::unknown(std::string_view element, std::string_view quantity) const {
    if (!elements_.contains(element)) {
        return {"unknown", fmt::format("there is no '{}'", printable(element))};
    }
    return {"not named", fmt::format("simulation.controls does not name '{}{}{}'", element, quantity.empty() ? "" : ".",
                                     printable(quantity))};
}

std::optional<Controls::Why> Controls::wrong_with(Asked const& asked, std::vector<std::string> const* from) const {
    if (std::find(from->begin(), from->end(), asked.process) == from->end()) {
        return Why{"not allowed", fmt::format("only '{}' may", join(*from, "' or '"))};
    }
    if (!std::isfinite(asked.valid_for_s) || asked.valid_for_s < 0) {
        return Why{"validity", fmt::format("valid_for_s is {}", number(asked.valid_for_s))};
    }
    if (asked.stamp > grid_.end) {
        return Why{"time",
                   fmt::format("its time is {} s, and the run ends at {} s: time_ns counts from simulated time 0",
                               shortest(grid_.base.seconds(asked.stamp)), shortest(grid_.base.seconds(grid_.end)))};
    }
    if (asked.valid_for_s > 0 && asked.effect > asked.stamp &&
        grid_.base.later(asked.stamp, asked.valid_for_s) <= asked.effect) {
        return Why{"expired",
                   fmt::format("it was valid until {} s, and it comes at {} s",
                               shortest(grid_.base.seconds(grid_.base.later(asked.stamp, asked.valid_for_s))),
                               shortest(grid_.base.seconds(asked.effect)))};
    }
    return {};
}

void Controls::set_point(Simulation& simulation, Asked const& asked, std::string_view quantity, double value) {
    auto const tell = [this](SimTime at, std::string_view event, std::string const& text) { tell_(at, event, text); };
    std::string const name = fmt::format("{}.{}", asked.element, quantity);
    auto const it = quantities_.find(name);
    auto const refuse_it = [&](Why const& why) {
        refuse("set_point_refused", asked, name, fmt::format("{} = {}", printable(name), number(value)), why);
    };
    if (it == quantities_.end()) {
        return refuse_it(unknown(asked.element, quantity));
    }
    Control& control = it->second.control;
    control.follow(simulation, asked.effect, tell);
    if (auto const why = wrong_with(asked, &it->second.from)) {
        return refuse_it(*why);
    }
    if (!std::isfinite(value)) {
        return refuse_it({"not finite", "it is no number"});
    }
    if (!within(control.limits().allowed, value)) {
        return refuse_it({"range", fmt::format("expected {}", range_text(control.limits().allowed))});
    }
    if (!control.holder().empty() && control.holder() != asked.process) {
        return refuse_it({"steered", fmt::format("'{}' steers it", control.holder())});
    }
    said_.erase({std::string{asked.process}, it->first});
    control.take(simulation, asked.effect, asked.process, value, asked.valid_for_s);
}

void Controls::command(Simulation& simulation, Asked const& asked, std::size_t index, std::string_view mode) {
    std::string_view const word = index < kCommands.size() ? kCommands[index] : "?";
    auto const it = commands_.find(asked.element);
    auto const refuse_it = [&](Why const& why) {
        refuse("command_refused", asked, std::string{asked.element},
               fmt::format("{}{}{} {}", word, mode.empty() ? "" : " ", printable(mode), printable(asked.element)), why);
    };
    if (it == commands_.end()) {
        return refuse_it(unknown(asked.element, ""));
    }
    if (auto const why = wrong_with(asked, &it->second.from)) {
        return refuse_it(*why);
    }
    auto const command = static_cast<Command>(index);
    if (!it->second.allowed.contains(command)) {
        std::vector<std::string> allowed;
        for (Command const one : it->second.allowed) {
            allowed.emplace_back(kCommands[static_cast<std::size_t>(one)]);
        }
        return refuse_it({"command", fmt::format("expected {}", join(allowed, ", "))});
    }
    std::vector<std::string> const& modes = it->second.modes;
    if (command == Command::mode && std::find(modes.begin(), modes.end(), mode) == modes.end()) {
        return refuse_it({"mode", fmt::format("expected {}", join(modes, ", "))});
    }
    said_.erase({std::string{asked.process}, it->first});
    std::string element{asked.element.substr(asked.element.find('.') + 1)};
    simulation.request(asked.effect, action_of(command, std::move(element), std::string{mode}), it->first);
}

void Controls::advance(Simulation& simulation, SimTime until) {
    for (auto& [name, quantity] : quantities_) {
        quantity.control.follow(simulation, until, tell_);
    }
}

void Controls::refuse(std::string_view event, Asked const& asked, std::string const& thing, std::string const& what,
                      Why const& why) {
    ++refused_;
    std::pair const key{std::string{asked.process}, thing};
    auto const it = said_.find(key);
    if (it != said_.end() ? it->second == why.kind : said_.size() >= kMaxSaid) {
        return;
    }
    said_[key] = why.kind;
    std::string const behalf =
        asked.source.empty() || asked.source == asked.process ? "" : fmt::format(" for '{}'", printable(asked.source));
    tell_(asked.effect, event, fmt::format("{} of '{}'{}: {}, ignored", what, asked.process, behalf, why.text));
}

void Controls::refused_by_engine(SimTime at, std::string const& name, Error const& error) {
    ++refused_;
    auto const [it, first] = said_.try_emplace({"", name}, "engine");
    if (first) {
        tell_(at, quantities_.contains(name) ? "set_point_refused" : "command_refused",
              fmt::format("{}: {}, ignored", name, error.message));
    }
}

} // namespace gridspace::sim

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/known_signals.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

std::string to_be_recorded(Scenario const& scenario) {
    bool const recorder = std::any_of(scenario.processes.begin(), scenario.processes.end(),
                                      [](Process const& p) { return p.program.name == "gridspace-recorder"; });
    return !recorder                  ? "a process with `program: gridspace-recorder` records it"
           : !scenario.record.samples ? "`record: {samples: all}` records it"
                                      : "";
}

/// Whether the report will know a signal. record.signals is about the simulator's; how long a detector takes is in a
/// file of its own.
bool is_recorded(Scenario const& scenario, Process const& process, std::string const& signal, bool samples) {
    if (matches_glob("ids.*.time_us_*", signal)) {
        return true;
    }
    std::vector<std::string> const& wanted = scenario.record.signals;
    return samples &&
           (&process != scenario.simulator() ||
            std::any_of(wanted.begin(), wanted.end(), [&](std::string const& p) { return matches_glob(p, signal); }));
}

bool among(std::vector<std::string> const& names, std::string const& pattern) {
    return std::any_of(names.begin(), names.end(), [&](std::string const& s) { return matches_glob(pattern, s); });
}

} // namespace

KnownSignals::KnownSignals(Scenario const& scenario) : remedy_{to_be_recorded(scenario)} {
    for (Process const& process : scenario.processes) {
        for (SignalUse& signal : process.settings->signals(scenario, process)) {
            if (is_recorded(scenario, process, signal.name, remedy_.empty())) {
                recorded_.push_back(signal.name);
            }
            signals_.push_back(std::move(signal.name));
        }
    }
    for (sim::Event const& event : scenario.events) {
        events_.push_back(event.name.name);
    }
    for (streams::Stream const& stream : scenario.streams) {
        names_.push_back(stream.name.name);
    }
    for (Process const& process : scenario.processes) {
        names_.push_back(process.name.name);
    }
}

void KnownSignals::check(std::vector<std::string> const& patterns, User const& user,
                         config::Diagnostics& diagnostics) const {
    for (std::string const& pattern : patterns) {
        if (!among(signals_, pattern)) {
            diagnostics.error(user.where,
                              fmt::format("{} uses the signal '{}', which does not exist", user.name, pattern),
                              did_you_mean(pattern, signals_, "`gridspace signals` lists them"), user.width);
        } else if (!among(recorded_, pattern)) {
            std::string const what = fmt::format("{} uses the signal '{}', which is not recorded", user.name, pattern);
            std::string const help = remedy_.empty() ? fmt::format("add \"{}\" to record.signals", pattern) : remedy_;
            user.lenient ? diagnostics.warning(user.where, what, help, user.width)
                         : diagnostics.error(user.where, what, help, user.width);
        }
    }
}

void KnownSignals::check(std::optional<Moment> const& moment, User const& user,
                         config::Diagnostics& diagnostics) const {
    if (moment && !moment->event.empty() && moment->event.find('.') == std::string::npos &&
        std::find(events_.begin(), events_.end(), moment->event) == events_.end()) {
        diagnostics.error(user.where,
                          fmt::format("{} refers to the event '{}', which does not exist", user.name, moment->event),
                          did_you_mean(moment->event, events_), user.width);
    }
}

void KnownSignals::check_name(std::string const& pattern, User const& user, config::Diagnostics& diagnostics) const {
    if (pattern != "*" && !among(names_, pattern)) {
        diagnostics.error(user.where,
                          fmt::format("{} is about '{}', which no stream and no process is called", user.name, pattern),
                          did_you_mean(pattern, names_), user.width);
    }
}

} // namespace gridspace::launcher

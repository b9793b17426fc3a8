// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/comtrade_settings.hpp"

#include "common/text.hpp"
#include "launcher/judge/protection_chain.hpp"
#include "launcher/scenario/scenario.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::launcher {

void describe(config::Fields& f, ComtradeSettings& settings) {
    f.reference("trigger", settings.trigger,
                {.doc = "what a record is written around: a relay's trip (`relay2.trip`) or pickup, a signal that "
                        "rises from zero, or an event",
                 .required = true});
    f.number("before_ms", settings.before_ms,
             {.doc = "begin of the record before the trigger", .min = 0, .max = 60'000});
    f.number("after_ms", settings.after_ms, {.doc = "end of the record after the trigger", .max = 60'000, .above = 0});
    f.flag("single_file", settings.single_file, {.doc = "one .cff in place of .cfg and .dat"});
    f.references("signals", settings.signals,
                 {.doc = "patterns of further analog channels; one word means all signals that end so. Always there: "
                         "currents of both ends, bus voltages, pickup, trip and poles"});
}

std::string comtrade_pattern(std::string const& written) {
    return written.find_first_of(".*?") == std::string::npos ? "*." + written : written;
}

ComtradeChannels usual_channels(config::Node const& scenario, std::string const& trigger_signal) {
    ComtradeChannels out;
    for (ProtectionChain const& chain : protection_chains(scenario)) {
        std::string const prefix = "relay." + chain.relay + ".";
        if (!trigger_signal.starts_with(prefix)) {
            continue;
        }
        for (ProtectionChain::End const& end : chain.ends) {
            if (!end.transformer.empty()) {
                out.analog.push_back("ct." + end.transformer + ".i.?");
            }
        }
        out.digital = {prefix + "pickup", prefix + "trip"};
        for (std::string const& breaker : chain.breakers()) {
            out.digital.push_back("breaker." + breaker + ".pole.?");
        }
    }
    if (out.digital.empty()) { // about something else: everything that a substation sees
        out.analog.push_back("ct.*.i.?");
        out.digital = {"relay.*.pickup", "relay.*.trip", "breaker.*.pole.?"};
    }
    out.analog.push_back("bus.*.v.?");
    return out;
}

void check_comtrade(Scenario const& s, config::Diagnostics& diagnostics) {
    if (!s.record.comtrade) {
        return;
    }
    ComtradeSettings const& settings = *s.record.comtrade;
    std::vector<std::string> signals, triggers;
    for (Process const& process : s.processes) {
        for (SignalUse const& signal : process.settings->signals(s, process)) {
            signals.push_back(signal.name);
            if (matches_glob("relay.*.trip", signal.name)) {
                triggers.push_back(signal.name.substr(6));
            }
        }
    }
    auto const known = [&](std::string const& pattern) {
        return std::any_of(signals.begin(), signals.end(),
                           [&](std::string const& name) { return matches_glob(pattern, name); });
    };
    std::vector<std::string> events;
    for (sim::Event const& event : s.events) {
        events.push_back(event.name.name);
    }
    auto const names = settings.trigger_signals();
    if (!settings.trigger.empty() && std::none_of(names.begin(), names.end(), known) &&
        std::find(events.begin(), events.end(), settings.trigger.name) == events.end()) {
        triggers.insert(triggers.end(), events.begin(), events.end());
        diagnostics.error(
            settings.trigger.where,
            fmt::format("record.comtrade waits for '{}', and there is no such signal or event", settings.trigger.name),
            spelling_hint(settings.trigger.name, triggers) + " (`gridspace signals` lists all signals)",
            static_cast<int>(settings.trigger.name.size()));
    }
    ComtradeChannels const usual = usual_channels(s.resolved, names.back());
    for (auto const* patterns : {&usual.analog, &usual.digital}) {
        for (std::string const& pattern : *patterns) {
            for (std::string const& signal : signals) {
                bool const published = signal.starts_with("relay.") || // record.signals is about the simulator's
                                       std::any_of(s.record.signals.begin(), s.record.signals.end(),
                                                   [&](std::string const& p) { return matches_glob(p, signal); });
                if (matches_glob(pattern, signal) && !published) {
                    diagnostics.warning(
                        settings.trigger.where,
                        fmt::format("record.comtrade wants '{}', which record.signals leaves out", signal),
                        fmt::format("add \"{}\" to record.signals", pattern),
                        static_cast<int>(settings.trigger.name.size()));
                    break; // once for each pattern
                }
            }
        }
    }
    for (config::Ref const& wanted : settings.signals) {
        if (!known(comtrade_pattern(wanted.name))) {
            diagnostics.warning(
                wanted.where,
                fmt::format("no signal matches '{}' of record.comtrade.signals: the files go without it", wanted.name),
                "`gridspace signals` lists them", static_cast<int>(wanted.name.size()));
        }
    }
}

} // namespace gridspace::launcher

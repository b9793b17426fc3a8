// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/run_signals.hpp"

#include "common/config/yaml.hpp"
#include "common/text.hpp"
#include "launcher/judge/named_signals.hpp"

#include <algorithm>
#include <set>

namespace gridspace::launcher {
namespace {

/// Of what a simulator publishes, whatever the scenario names.
bool is_looked_at(std::string const& signal, bool disturbed) {
    return signal.starts_with("breaker.") || signal.starts_with("fuse.") ||
           (disturbed && matches_glob("load.*.p_kw", signal));
}

} // namespace

KeepRule needed_signals(Results& results, AlsoNamed also_named) {
    config::Diagnostics unread;
    auto const scenario = config::load_yaml(results.folder / "scenario.resolved.yaml", unread);
    if (!scenario) {
        return [](std::string const&, std::string const&) { return Keep::all; };
    }
    std::set<std::string> simulators;
    for (Results::ProcessRow const& process : results.processes) {
        if (process.program == "gridspace-sim") {
            simulators.insert(process.name);
        }
    }
    return [&results, simulators,
            named = NamedSignals{*scenario, also_named == nullptr ? std::string_view{} : also_named(*scenario)},
            disturbed = is_disturbed(*scenario)](std::string const& source, std::string const& signal) {
        if (!simulators.contains(source) || is_looked_at(signal, disturbed) || named.contains(signal)) {
            return Keep::all;
        }
        results.last_values.insert(signal);
        return Keep::spans;
    };
}

Result<SignalStore> signals_within(Results const& results, std::vector<std::string> const& patterns,
                                   Spans const& spans) {
    auto const wanted = [&](std::string const& signal) {
        return std::ranges::any_of(patterns, [&](std::string const& p) { return matches_glob(p, signal); });
    };
    SignalStore out;
    bool whole = true;
    for (auto const& [name, series] : results.signals) {
        if (wanted(name)) {
            bool const last_value = results.last_values.contains(name);
            out[name] = last_value ? SignalSeries{} : series;
            whole &= !last_value;
        }
    }
    if (whole) {
        return out;
    }
    auto rest = read_signals(
        results.folder / "data.mcap",
        [&](std::string const&, std::string const& signal) {
            return results.last_values.contains(signal) && wanted(signal) ? Keep::spans : Keep::none;
        },
        spans);
    if (!rest) {
        return std::unexpected{rest.error()};
    }
    std::ranges::for_each(*rest, [&](auto& read) { out[read.first] = std::move(read.second); });
    return out;
}

} // namespace gridspace::launcher

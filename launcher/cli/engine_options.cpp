// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/engine_options.hpp"

#include "common/text.hpp"
#include "common/time.hpp"
#include "launcher/cli/checks.hpp"
#include "sim/solvers/step.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::cli {

void engine_options(Command verb, EngineOptions& o) {
    verb.add_flag("--fixed-step", o.fixed_step, "phasor: steps of --step, not of the integrator's choice");
    verb.add_option("--solver", o.solver, "emt (waveforms) or phasor").check(one_of({"emt", "phasor"}));
    verb.add_option("--until", o.until, "end at this simulated time: 10s, 5min, 2h");
    verb.add_option(
        "--step", o.step,
        "time step in seconds (default: 1/48000 for emt, 1/1000 for phasor), or auto (emt): what the network needs");
}

Result<ChosenEngine> chosen_engine(EngineOptions const& o) {
    bool const emt = o.solver == "emt";
    if (emt && o.fixed_step) {
        return fail(ExitCode::usage, "--fixed-step is for phasors: waveforms always have fixed steps", "leave it out");
    }
    auto const until = parse_duration(o.until);
    bool const automatic = o.step == "auto";
    if (automatic && !emt) {
        return fail(ExitCode::usage, "--step auto is for waveforms: phasors have nothing that rings",
                    "a time in seconds, for example 1/1000");
    }
    auto const step = Rational::parse(o.step.empty() || automatic ? (emt ? "1/48000" : "1/1000") : o.step);
    if (!until) {
        return fail(ExitCode::usage, fmt::format("--until '{}' is not a duration", o.until),
                    "for example 10s, 5min or 2h");
    }
    if (!step || *step <= Rational{0}) {
        return fail(ExitCode::usage, fmt::format("--step '{}' is not a time in seconds", o.step),
                    "for example 1/48000");
    }
    sim::EngineSettings settings;
    settings.solver = emt ? sim::SolverKind::emt : sim::SolverKind::phasor;
    settings.step_s = *step;
    settings.step_auto = automatic;
    settings.fixed_step = o.fixed_step;
    return ChosenEngine{settings, *until};
}

void settle_step(sim::EngineSettings& settings, sim::Network const& network, bool quiet) {
    sim::settle_step(settings, network, sim::kUsualSamplePeriod);
    if (quiet) {
        return;
    }
    if (settings.step_auto) {
        fmt::print(stderr, "steps of {} s\n", settings.step_s.to_string());
    }
    if (auto const warning = sim::step_warning(settings, network, sim::kUsualSamplePeriod)) {
        fmt::print(stderr, "warning: {}: {}\n", warning->message, warning->hint);
    }
}

Result<std::vector<std::size_t>> choose(std::vector<std::string> const& names, std::vector<std::string> const& asked,
                                        std::vector<std::string> const& usual, std::string_view what,
                                        std::string_view shown_by) {
    std::vector<std::string> const& patterns = asked.empty() ? usual : asked;
    std::vector<std::size_t> out;
    std::vector<bool> taken(names.size());
    for (std::string const& pattern : patterns) {
        bool any = false;
        for (std::size_t i = 0; i < names.size(); ++i) {
            if (matches_glob(pattern, names[i])) {
                any = true;
                if (!taken[i]) {
                    taken[i] = true;
                    out.push_back(i);
                }
            }
        }
        if (!any && !asked.empty()) {
            return fail(ExitCode::usage, fmt::format("no {} matches '{}'", what, pattern),
                        did_you_mean(pattern, names, shown_by));
        }
    }
    return out;
}

std::vector<std::string> names_of(std::vector<sim::SignalDef> const& signals) {
    std::vector<std::string> out;
    for (sim::SignalDef const& signal : signals) {
        out.push_back(signal.name);
    }
    return out;
}

} // namespace gridspace::cli

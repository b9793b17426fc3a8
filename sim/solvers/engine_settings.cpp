// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/solvers/engine_settings.hpp"

#include "common/time.hpp"

#include <fmt/format.h>
#include <optional>

namespace gridspace::sim {

void describe(config::Fields& f, EngineSettings& s) {
    f.choice<SolverKind>("solver", s.solver, {{"phasor", SolverKind::phasor}, {"emt", SolverKind::emt}},
                         {.doc = "balanced phasors, or waveforms", .required = true});
    bool const given = f.has("step_s");
    std::optional<Rational> step_s = given ? std::optional{s.step_s} : std::nullopt; // kept where it is wrong
    f.fraction("step_s", step_s,
               {.doc = "time step; fractions like 1/48000 are exact; auto (waveforms): the longest that resolves what "
                       "the network rings with",
                .required = true,
                .above = 0,
                .word = "auto"});
    s.step_s = step_s.value_or(s.step_s);
    s.step_auto = given && !step_s;
    if (s.step_auto && s.solver == SolverKind::phasor) {
        f.error("step_s", "phasors have no step that would have to resolve an oscillation", "give a number");
    }
    f.choice<bool>("integration", s.fixed_step, {{"adaptive", false}, {"fixed_step", true}},
                   {.doc = "phasor: steps chosen by the integrator, or of step_s with bounded work, for real time"});
    if (s.fixed_step && s.solver == SolverKind::emt) {
        f.error("integration", "waveforms always have steps of step_s", "leave it out");
    }
    f.integer("threads", s.threads,
              {.doc = "waveforms: processors that step a large network together, with the same results for any number",
               .min = 1,
               .max = kMostThreads});
    if (s.threads > 1 && s.solver == SolverKind::phasor) {
        f.error("threads", "phasors are stepped by one thread", "leave it out");
    }
    f.text("epoch", s.epoch, {.doc = "UTC of simulated time 0"});
    if (!parse_utc(s.epoch)) {
        f.error("epoch", fmt::format("'{}' is not a UTC time from 1970 to 2199", s.epoch),
                "for example \"2019-12-01T09:00:00Z\"");
    }
}

double start_hour_of_day(EngineSettings const& settings) {
    std::int64_t const epoch = parse_utc(settings.epoch).value_or(0);
    return static_cast<double>(((epoch % 86400) + 86400) % 86400) / 3600;
}

} // namespace gridspace::sim

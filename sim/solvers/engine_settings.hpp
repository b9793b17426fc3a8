// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <cstdint>
#include <string>

namespace gridspace::sim {

enum class SolverKind { phasor, emt };

/// More threads than this do not meet in time.
constexpr std::int64_t kMostThreads = 64;

/// How a network is simulated.
struct EngineSettings {
    SolverKind solver{SolverKind::phasor};
    Rational step_s{1};
    bool step_auto{false};                     ///< `step_s: auto` (waveforms): settle_step() says which it is
    bool fixed_step{false};                    ///< phasors in steps of step_s, not in steps of the integrator's choice
    std::int64_t threads{1};                   ///< waveforms: that step a large network together
    std::string epoch{"2020-01-01T00:00:00Z"}; ///< UTC of simulated time 0
    [[nodiscard]] bool waveform() const { return solver == SolverKind::emt; }
};
void describe(config::Fields& f, EngineSettings& settings);

/// UTC hour of the day of simulated time 0.
[[nodiscard]] double start_hour_of_day(EngineSettings const& settings);

} // namespace gridspace::sim

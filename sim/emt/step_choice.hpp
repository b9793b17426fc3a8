// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/rational.hpp"
#include "common/result.hpp"
#include "sim/emt/modes.hpp"
#include "sim/network/network.hpp"

#include <optional>
#include <string>

/// How long a step of the waveform simulation may be. With n steps in a period the trapezoidal rule turns a frequency
/// down by (2 pi / n)^2 / 12, and the four backward Euler half steps after a switching take 1 - (1 + (pi / n)^2)^-2 of
/// what then begins to ring [tested against analytic circuits]: 2 % with 30 steps, 5 % with 20, 17 % with 10.
namespace gridspace::sim::emt {

/// Steps in a period of what rings: `step_s: auto` takes so many, fewer than the second are warned of.
constexpr double kGoodStepsPerPeriod = 30, kFewStepsPerPeriod = 20;
/// Of the fundamental: the time is cut as finely where nothing rings.
constexpr double kStepsPerFundamental = 200;
/// `step_s: auto` takes no shorter step: what is faster is then too fast for it, and is warned of.
constexpr double kShortestAutoStep = 1e-6;

/// What the step of a network has to resolve.
struct StepNeeds {
    double longest_s{0};      ///< for the fundamental, harmonics of sources and travel times
    std::string reason;       ///< which of them it is
    std::optional<Mode> mode; ///< the fastest that rings, with poles as at the start or all closed
};
/// Capacitances of less than 1 % of the network's base power at a bus do not count: filters of averaged converters, and
/// cables so short that no step of use shows their own resonance.
[[nodiscard]] Result<StepNeeds> step_needs(Network const& network, double start_hour_of_day);

/// The longest step that is a whole part of `period` and resolves all of it, within kShortestAutoStep.
[[nodiscard]] Rational resolving_step(StepNeeds const& needs, Rational period);

/// What steps of `step_s` get wrong; nothing when they resolve the fastest mode. `period`: of which steps are whole
/// parts, for what is advised.
struct StepAdvice {
    std::string message, remedy;
};
[[nodiscard]] std::optional<StepAdvice> step_advice(StepNeeds const& needs, double step_s, Rational period);

} // namespace gridspace::sim::emt

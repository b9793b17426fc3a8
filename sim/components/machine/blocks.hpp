// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

/// Blocks of regulators, as their diagrams draw them.
namespace gridspace::sim::machines {

/// Motion of a first-order lag towards `target`; a state without time constant is set by limit() instead.
inline double lag(double target, double x, double t) {
    return t > 0 ? (target - x) / t : 0;
}

/// Output of (1 + lead s) / (1 + lag s) whose lag is at `x`; without one its input.
inline double lead_lag(double input, double x, double lead, double lag) {
    return lag > 0 ? x + lead / lag * (input - x) : input;
}

/// Motion of a state that does not leave its limits (421.5, non-windup): `slope`, but for the last of the way, which it
/// goes with a time constant of 1 ms. A limit that moves is followed so too, and the equations stay continuous.
inline double held(double slope, double x, double lowest, double highest) {
    constexpr double kStopS = 1e-3;
    return std::clamp(slope, (lowest - x) / kStopS, (highest - x) / kStopS);
}

} // namespace gridspace::sim::machines

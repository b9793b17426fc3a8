// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace gridspace::sim::emt {

/// alpha, beta (space vector of phase peaks) and zero sequence.
struct Space {
    double alpha{0}, beta{0}, zero{0};
};
[[nodiscard]] inline Space to_space(double a, double b, double c) {
    constexpr double kInverseRoot3 = 0.57735026918962576451;
    return {(2 * a - b - c) / 3, (b - c) * kInverseRoot3, (a + b + c) / 3};
}
[[nodiscard]] inline std::array<double, 3> to_phases(Space const& s) {
    constexpr double kHalfRoot3 = 0.86602540378443864676;
    return {s.alpha + s.zero, -s.alpha / 2 + kHalfRoot3 * s.beta + s.zero, -s.alpha / 2 - kHalfRoot3 * s.beta + s.zero};
}

} // namespace gridspace::sim::emt

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/common/line_sample.hpp"

#include <array>
#include <cmath>
#include <complex>

namespace gridspace::relay {

using Complex = std::complex<double>;
/// Phases a, b, c; r.m.s.
using Phasors = std::array<Complex, 3>;

/// By a square root, which every machine rounds alike.
[[nodiscard]] inline double magnitude(Complex z) {
    return std::sqrt(z.real() * z.real() + z.imag() * z.imag());
}
[[nodiscard]] inline Abc magnitudes(Phasors const& p) {
    return {magnitude(p[0]), magnitude(p[1]), magnitude(p[2])};
}

/// a = 1 at 120 degrees.
inline constexpr Complex kTurn{-0.5, 0.86602540378443864676};
inline constexpr Complex kTurnBack{-0.5, -0.86602540378443864676};

/// Symmetrical components, referred to phase a [Fortescue 1918].
struct Sequence {
    Complex zero, positive, negative;
};
[[nodiscard]] inline Sequence sequence_of(Phasors const& p) {
    return {(p[0] + p[1] + p[2]) / 3.0, (p[0] + kTurn * p[1] + kTurnBack * p[2]) / 3.0,
            (p[0] + kTurnBack * p[1] + kTurn * p[2]) / 3.0};
}

} // namespace gridspace::relay

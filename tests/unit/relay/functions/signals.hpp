// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/functions/function.hpp"

#include <numbers>
#include <vector>

namespace gridspace::relay {

inline constexpr double kRateHz = 4800;

[[nodiscard]] inline Complex polar(double magnitude, double degrees) {
    return std::polar(magnitude, degrees * std::numbers::pi / 180);
}
/// Phase a, and b and c behind it.
[[nodiscard]] inline Phasors balanced(Complex a) {
    return {a, a * kTurnBack, a * kTurn};
}
[[nodiscard]] inline Measurement measurement(Phasors const& i, Phasors const& v = {}) {
    Measurement m;
    m.i = i;
    m.v = v;
    m.i_sequence = sequence_of(i);
    m.v_sequence = sequence_of(v);
    m.polarising = m.v_sequence.positive;
    m.available = 0xFF;
    return m;
}

/// Steps until it operates; how long it took in seconds from the first sample on, or less than 0 when it did not.
template <class F>
double time_to_operate(F& sut, Measurement const& m, double at_most_s, bool trip = false) {
    for (std::int64_t k = 0; k <= samples_of(at_most_s, kRateHz); ++k) {
        if (sut.step({m, {}, trip}).op) {
            return static_cast<double>(k) / kRateHz;
        }
    }
    return -1;
}
template <class F>
FunctionState after(F& sut, Measurement const& m, double seconds, bool trip = false) {
    FunctionState out;
    for (std::int64_t k = 0; k <= samples_of(seconds, kRateHz); ++k) {
        out = sut.step({m, {}, trip});
    }
    return out;
}

/// Instantaneous values of three phasors that turn with `hz`, at `t`.
[[nodiscard]] inline Abc at(Phasors const& p, double hz, double t) {
    Abc out{};
    for (std::size_t k = 0; k < 3; ++k) {
        out[k] = std::numbers::sqrt2 * std::abs(p[k]) * std::cos(2 * std::numbers::pi * hz * t + std::arg(p[k]));
    }
    return out;
}

} // namespace gridspace::relay

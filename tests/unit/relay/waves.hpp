// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/common/line_sample.hpp"

#include <cmath>
#include <numbers>

namespace gridspace::relay {

/// Balanced three-phase cosine, phase a at its crest at sample 0.
inline Abc wave(double rms_a, double angle_deg, std::int64_t index, int samples_per_cycle = 80) {
    Abc out{};
    for (int p = 0; p < 3; ++p) {
        double const angle =
            2 * std::numbers::pi * (static_cast<double>(index) / samples_per_cycle + angle_deg / 360 - p / 3.0);
        out[static_cast<std::size_t>(p)] = rms_a * std::numbers::sqrt2 * std::cos(angle);
    }
    return out;
}

inline EndSample good(Abc const& i) {
    EndSample s;
    s.i_a = i;
    s.present = true;
    return s;
}

/// A healthy line: the same current at both ends, counted along the line.
inline LineSample through(std::int64_t index, double rms_a = 12.66, int samples_per_cycle = 80) {
    EndSample const s = good(wave(rms_a, 0, index, samples_per_cycle));
    return {index, s, s};
}

} // namespace gridspace::relay

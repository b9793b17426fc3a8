// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/element.hpp"

namespace gridspace::sim {

/// More current than this share of its rating no converter gives.
constexpr double kConverterOverload = 1.2;

/// What a converter of this rating can give of `s` at a voltage v (p.u.): its current is limited.
inline Complex within_rating(Complex s, double v, double rating) {
    double const most = kConverterOverload * rating * v;
    double const size = std::abs(s);
    return size > most ? s * (most / size) : s;
}

} // namespace gridspace::sim

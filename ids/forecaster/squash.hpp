// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/elementary.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace gridspace::ids {

using DoublePair = double __attribute__((vector_size(16))); ///< in one register on x86-64 and ARM64

/// elementary::tanh of two numbers below 20 at once: the same steps, so the same bits.
inline DoublePair tanh_of_pair(DoublePair x) {
    DoublePair const y = 2 * x, t = y * 1.4426950408889634 + 0.5;
    DoublePair k{}, scale{};
    for (int i = 0; i < 2; ++i) {
        auto whole = static_cast<std::int64_t>(t[i]); // floor() is a call where there is no instruction for it
        whole -= static_cast<double>(whole) > t[i] ? 1 : 0;
        k[i] = static_cast<double>(whole);
        scale[i] = elementary::power_of_two(whole);
    }
    return elementary::tanh_of(y, k, scale);
}

/// The hyperbolic tangent of each of them, as elementary::tanh has it.
template <class Real>
void squash(Real* values, std::size_t count) {
    std::size_t i = 0;
    if constexpr (sizeof(Real) == sizeof(double)) {
        for (; i + 2 <= count; i += 2) {
            if (!(std::fabs(values[i]) < 20) || !(std::fabs(values[i + 1]) < 20)) {
                values[i] = elementary::tanh(values[i]);
                values[i + 1] = elementary::tanh(values[i + 1]);
                continue;
            }
            DoublePair const out = tanh_of_pair(DoublePair{values[i], values[i + 1]});
            values[i] = out[0];
            values[i + 1] = out[1];
        }
    }
    for (; i < count; ++i) {
        values[i] = elementary::tanh(values[i]);
    }
}

} // namespace gridspace::ids

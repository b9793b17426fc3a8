// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/elementary.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

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
        std::uint64_t const bits = static_cast<std::uint64_t>(whole + 1023) << 52;
        double power = 0;
        std::memcpy(&power, &bits, sizeof power);
        scale[i] = power;
    }
    DoublePair const r = (y - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
    DoublePair p = DoublePair{} + 1.0 / 6227020800.0;
    p = p * r + 1.0 / 479001600.0;
    p = p * r + 1.0 / 39916800.0;
    p = p * r + 1.0 / 3628800.0;
    p = p * r + 1.0 / 362880.0;
    p = p * r + 1.0 / 40320.0;
    p = p * r + 1.0 / 5040.0;
    p = p * r + 1.0 / 720.0;
    p = p * r + 1.0 / 120.0;
    p = p * r + 1.0 / 24.0;
    p = p * r + 1.0 / 6.0;
    p = p * r + 0.5;
    p = p * r * r + r;
    DoublePair const m = (scale - 1) + scale * p;
    return m / (m + 2);
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

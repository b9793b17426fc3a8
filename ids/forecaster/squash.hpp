// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/elementary.hpp"
#include "ids/forecaster/double_pairs.hpp"

#include <cstddef>
#include <cstring>

namespace gridspace::ids {

/// A number of magnitude below 2^51 plus this has its whole part, rounded, in its lowest bits.
inline constexpr double kWholeBits = 6755399441055744.0; // 1.5 x 2^52

/// std::floor of two numbers of magnitude below 2^51, without a call.
inline DoublePair floor_of(DoublePair x) {
    DoublePair const nearest = (x + kWholeBits) - kWholeBits;
    return nearest > x ? nearest - 1.0 : nearest;
}

/// elementary::power_of_two of two whole numbers from -1022 to 1023.
inline DoublePair powers_of_two(DoublePair k) {
    DoublePair const biased = k + (kWholeBits + 1023);
    IntegerPair bits;
    std::memcpy(&bits, &biased, sizeof bits);
    bits <<= 52;
    DoublePair out;
    std::memcpy(&out, &bits, sizeof out);
    return out;
}

/// elementary::tanh of `2 n` numbers at once: the same steps, so the same bits. From 20 on it is 1 by these steps too.
template <std::size_t n>
[[gnu::flatten]] void tanh_together(double* values) {
    DoublePairs<n> x = DoublePairs<n>::from(values);
    for (DoublePair& pair : x.pair) {
        pair = pair > 20.0 ? DoublePair{20, 20} : pair;
        pair = pair < -20.0 ? DoublePair{-20, -20} : pair;
    }
    DoublePairs<n> const y = x * 2, t = y * 1.4426950408889634 + 0.5;
    auto const k = DoublePairs<n>::each([&](std::size_t i) { return floor_of(t.pair[i]); });
    auto const scale = DoublePairs<n>::each([&](std::size_t i) { return powers_of_two(k.pair[i]); });
    elementary::tanh_of(y, k, scale).to(values);
}

/// The hyperbolic tangent of each of them, as elementary::tanh has it.
template <class Real>
void squash(Real* values, std::size_t count) {
    std::size_t i = 0;
    if constexpr (sizeof(Real) == sizeof(double)) {
        for (; i + 10 <= count; i += 10) {
            tanh_together<5>(values + i);
        }
        for (; i + 2 <= count; i += 2) {
            tanh_together<1>(values + i);
        }
    }
    for (; i < count; ++i) {
        values[i] = elementary::tanh(values[i]);
    }
}

} // namespace gridspace::ids

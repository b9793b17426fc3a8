// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

/// Elementary functions that give the same bits on every machine and with every libm, where a recorded result depends
/// on them: fixed polynomials, plain arithmetic, no fused multiply-add (the build switches contraction off).
namespace gridspace::elementary {

/// |x| <= 1e6; within 2 units in the last place there.
[[nodiscard]] double sin(double x);
[[nodiscard]] double cos(double x);

/// e^x: within 2 units in the last place for |x| <= 700; 0 below, infinity above.
[[nodiscard]] double exp(double x);

/// Natural logarithm of x > 0 (normal numbers), within 2 units in the last place.
[[nodiscard]] double log(double x);

/// (y, x) as std::atan2, within 4 units in the last place.
[[nodiscard]] double atan2(double y, double x);

/// The rest of tanh where k = floor(y / ln(2) + 1/2) and scale = 2^k are known, y = 2 x: m / (m + 2) with m = e^y - 1
/// and e^y = 2^k e^r, |r| <= ln(2)/2. V is double, or several of them in one register.
template <class V>
[[nodiscard]] inline V tanh_of(V y, V k, V scale) {
    V const r = (y - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
    V p = V{} + 1.0 / 6227020800.0;
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
    p = p * r * r + r; // e^r - 1
    V const m = (scale - 1) + scale * p;
    return m / (m + 2);
}

/// 2^k as a double; k is whole, from -1022 to 1023.
[[nodiscard]] inline double power_of_two(std::int64_t k) {
    std::uint64_t const bits = static_cast<std::uint64_t>(k + 1023) << 52;
    double out = 0;
    std::memcpy(&out, &bits, sizeof out);
    return out;
}

/// Hyperbolic tangent, inline because a network asks it for every neuron. Real is double or float.
template <class Real>
[[nodiscard]] inline Real tanh(Real x);

template <>
[[nodiscard]] inline double tanh(double x) {
    double const y = 2 * x;
    if (!(std::fabs(y) < 40)) {
        return x > 0 ? 1.0 : x < 0 ? -1.0 : x; // NaN stays NaN
    }
    double const k = std::floor(y * 1.4426950408889634 + 0.5);
    return tanh_of(y, k, power_of_two(static_cast<std::int64_t>(k)));
}

template <>
[[nodiscard]] inline float tanh(float x) {
    float const y = 2 * x;
    if (!(std::fabs(y) < 18)) {
        return x > 0 ? 1.0F : x < 0 ? -1.0F : x;
    }
    float const k = std::floor(y * 1.44269504F + 0.5F);
    float const r = (y - k * 0.693359375F) - k * -2.12194440e-4F;
    float p = 1.0F / 5040;
    p = p * r + 1.0F / 720;
    p = p * r + 1.0F / 120;
    p = p * r + 1.0F / 24;
    p = p * r + 1.0F / 6;
    p = p * r + 0.5F;
    p = p * r * r + r;
    std::uint32_t const bits = static_cast<std::uint32_t>(static_cast<std::int32_t>(k) + 127) << 23;
    float scale = 0;
    std::memcpy(&scale, &bits, sizeof scale);
    float const m = (scale - 1) + scale * p;
    return m / (m + 2);
}

} // namespace gridspace::elementary

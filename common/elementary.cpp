// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/elementary.hpp"

#include <limits>

namespace gridspace::elementary {
namespace {

constexpr double kPi = 3.141592653589793;

struct Reduced {
    double r;    ///< |r| <= pi/4
    int quarter; ///< multiples of pi/2 that were taken off, modulo 4
};

/// Takes off multiples of pi/2, held in three parts of 33 bits so that the products are exact (Cody and Waite).
Reduced reduce(double x) {
    double const k = std::floor(x * 0.6366197723675814 + 0.5);
    double const r =
        ((x - k * 1.57079632673412561417e+00) - k * 6.07710050630396597660e-11) - k * 2.02226624879595063154e-21;
    auto const whole = static_cast<std::int64_t>(k);
    return {r, static_cast<int>(((whole % 4) + 4) % 4)};
}

double sin_small(double x) {
    double const z = x * x;
    double p = -1.0 / 1307674368000.0;
    p = p * z + 1.0 / 6227020800.0;
    p = p * z - 1.0 / 39916800.0;
    p = p * z + 1.0 / 362880.0;
    p = p * z - 1.0 / 5040.0;
    p = p * z + 1.0 / 120.0;
    p = p * z - 1.0 / 6.0;
    return x + x * z * p;
}

double cos_small(double x) {
    double const z = x * x;
    double p = 1.0 / 20922789888000.0;
    p = p * z - 1.0 / 87178291200.0;
    p = p * z + 1.0 / 479001600.0;
    p = p * z - 1.0 / 3628800.0;
    p = p * z + 1.0 / 40320.0;
    p = p * z - 1.0 / 720.0;
    p = p * z + 1.0 / 24.0;
    return 1 - (0.5 * z - z * z * p);
}

/// The quarter turns of sine, starting at `quarter`.
double turn(Reduced a, int shift) {
    switch ((a.quarter + shift) % 4) {
    case 0:
        return sin_small(a.r);
    case 1:
        return cos_small(a.r);
    case 2:
        return -sin_small(a.r);
    default:
        return -cos_small(a.r);
    }
}

/// |x| <= tan(pi/16); the series of the arc tangent.
double atan_small(double x) {
    double const z = x * x;
    double p = 0;
    for (int n = 25; n >= 3; n -= 2) {
        p = p * z + (n % 4 == 3 ? -1.0 : 1.0) / n;
    }
    return x + x * z * p;
}

double atan_positive(double x) {
    if (x > 1) {
        return kPi / 2 - atan_positive(1 / x);
    }
    // atan(x) = atan(c) + atan((x - c) / (1 + c x)) with tan of multiples of pi/8
    if (x > 0.6681786379192989) {
        return kPi / 4 + atan_small((x - 1) / (1 + x));
    }
    if (x > 0.198912367379658) {
        constexpr double kTan = 0.41421356237309503; // tan(pi/8)
        return kPi / 8 + atan_small((x - kTan) / (1 + kTan * x));
    }
    return atan_small(x);
}

} // namespace

double sin(double x) {
    return turn(reduce(x), 0);
}
double cos(double x) {
    return turn(reduce(x), 1);
}

double exp(double x) {
    if (!(x > -700)) {
        return x <= -700 ? 0.0 : x;
    }
    if (x > 700) {
        return std::numeric_limits<double>::infinity();
    }
    double const k = std::floor(x * 1.4426950408889634 + 0.5);
    double const r = (x - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
    double p = 1;
    for (int n = 13; n >= 1; --n) {
        p = 1 + p * r / n;
    }
    return std::ldexp(p, static_cast<int>(k));
}

double log(double x) {
    if (!(x > 0)) {
        return x == 0 ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
    }
    int e = 0;
    double m = std::frexp(x, &e);
    if (m < 0.7071067811865476) {
        m *= 2;
        --e;
    }
    double const s = (m - 1) / (m + 1), z = s * s;
    double p = 0;
    for (int n = 21; n >= 3; n -= 2) {
        p = p * z + 1.0 / n;
    }
    double const k = e;
    return k * 6.93147180369123816490e-01 + (2 * s + (2 * s * z * p + k * 1.90821492927058770002e-10));
}

double atan2(double y, double x) {
    if (x == 0 && y == 0) {
        return std::atan2(y, x); // exact by definition: signed zeros and pi
    }
    double const a = atan_positive(std::fabs(y) / std::fabs(x));
    double const half = x < 0 || (x == 0 && std::signbit(x)) ? kPi - a : a;
    return std::signbit(y) ? -half : half;
}

} // namespace gridspace::elementary

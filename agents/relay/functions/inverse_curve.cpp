// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/inverse_curve.hpp"

#include "common/elementary.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

namespace gridspace::relay {
namespace {

struct Constants {
    double k, c, alpha, reset;
};

Constants constants_of(Curve curve) {
    switch (curve) {
    case Curve::iec_normal_inverse:
        return {0.14, 0, 0.02, 0};
    case Curve::iec_very_inverse:
        return {13.5, 0, 1, 0};
    case Curve::iec_extremely_inverse:
        return {80, 0, 2, 0};
    case Curve::ieee_moderately_inverse:
        return {0.0515, 0.114, 0.02, 4.85};
    case Curve::ieee_very_inverse:
        return {19.61, 0.491, 2, 21.6};
    case Curve::ieee_extremely_inverse:
        return {28.2, 0.1217, 2, 29.1};
    case Curve::definite_time:
        break;
    }
    return {};
}

double power(double base, double exponent) {
    return exponent == 1 ? base : exponent == 2 ? base * base : elementary::exp(exponent * elementary::log(base));
}

} // namespace

double operate_time_s(Curve curve, double ratio) {
    Constants const of = constants_of(curve);
    if (!(ratio > 1)) {
        return std::numeric_limits<double>::infinity();
    }
    return of.k / (power(std::min(ratio, kCurveEnds), of.alpha) - 1) + of.c;
}

bool has_dependent_reset(Curve curve) {
    return constants_of(curve).reset > 0;
}

double reset_time_s(Curve curve, double ratio) {
    assert(has_dependent_reset(curve));
    constexpr double kAlpha = 2; // of D, too: table A.1
    return constants_of(curve).reset / (1 - power(std::clamp(ratio, 0.0, 1.0), kAlpha));
}

} // namespace gridspace::relay

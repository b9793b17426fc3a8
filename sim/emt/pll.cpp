// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/pll.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::sim::emt {
namespace {

constexpr double kNatural = 6.283185307179586477 * Pll::kBandwidthHz;
constexpr double kProportional = 2 * 0.70710678118654752 * kNatural;
constexpr double kIntegral = kNatural * kNatural;
/// Below this (V) there is nothing to lock on: the loop runs on.
constexpr double kNoVoltage = 1e-6;

/// Share of nominal frequency by which the loop's own frequency may be off: what it follows on a dead bus is noise.
constexpr double kMaxOff = 0.25;

/// Sine and cosine of a small angle by their series (|x| < 0.5: exact to rounding), without the library.
void small_rotation(double x, double& s, double& c) {
    double const y = x * x;
    s = x + x * y * (-1. / 6 + y * (1. / 120 + y * (-1. / 5040 + y * (1. / 362880 + y * (-1. / 39916800)))));
    c = 1 +
        y * (-1. / 2 + y * (1. / 24 + y * (-1. / 720 + y * (1. / 40320 + y * (-1. / 3628800 + y * (1. / 479001600))))));
}

} // namespace

void Pll::start(double alpha, double beta) {
    double const size = std::sqrt(alpha * alpha + beta * beta);
    w_ = w0_;
    integral_ = 0;
    cos_ = size > kNoVoltage ? alpha / size : 1;
    sin_ = size > kNoVoltage ? beta / size : 0;
}

std::pair<double, double> Pll::ahead(double h) const {
    double s, c;
    double const angle = w_ * h;
    if (std::abs(angle) < 0.5) [[likely]] {
        small_rotation(angle, s, c);
    } else {
        s = std::sin(angle);
        c = std::cos(angle);
    }
    return {cos_ * c - sin_ * s, sin_ * c + cos_ * s};
}

void Pll::step(double alpha, double beta, double h) {
    auto const [c, s] = ahead(h);
    double const length = 1.5 - 0.5 * (c * c + s * s); // back to 1, to first order
    cos_ = c * length;
    sin_ = s * length;
    double const size = std::sqrt(alpha * alpha + beta * beta);
    double const error = size > kNoVoltage ? (beta * cos_ - alpha * sin_) / size : 0;
    double const most = kMaxOff * w0_;
    integral_ = std::clamp(integral_ + kIntegral * error * h, -most, most);
    w_ = w0_ + integral_ + kProportional * error;
}

} // namespace gridspace::sim::emt

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

namespace gridspace::sim::emt {

/// Phase-locked loop in the synchronous reference frame on a bus voltage; natural frequency 10 Hz, damping 0.707. Its
/// integral part stays within a quarter of nominal frequency, so that it locks again after an outage of any length.
/// [Kaura and Blasko, IEEE Trans. Ind. Appl. 33(1), 1997]
class Pll {
  public:
    static constexpr double kBandwidthHz = 10;
    explicit Pll(double frequency_hz = 60) : w0_{6.283185307179586477 * frequency_hz}, w_{w0_} {}

    /// Locked on a space vector.
    void start(double alpha, double beta);
    /// After h seconds, with the space vector as it is now, and its length.
    void step(double alpha, double beta, double size, double h);
    void step(double alpha, double beta, double h) { step(alpha, beta, std::sqrt(alpha * alpha + beta * beta), h); }
    /// Cosine and sine of the angle that it will have h from now.
    [[nodiscard]] std::pair<double, double> ahead(double h);
    /// Runs on at nominal frequency from now.
    void rest() { integral_ = 0; }
    [[nodiscard]] double frequency_hz() const { return w_ / 6.283185307179586477; }

  private:
    static constexpr double kNatural = 6.283185307179586477 * kBandwidthHz;
    static constexpr double kProportional = 2 * 0.70710678118654752 * kNatural;
    static constexpr double kIntegral = kNatural * kNatural;
    /// Below this (V) there is nothing to lock on: the loop runs on.
    static constexpr double kNoVoltage = 1e-6;
    /// Share of nominal frequency by which the loop's own frequency may be off: what it follows on a dead bus is noise.
    static constexpr double kMaxOff = 0.25;
    double w0_, w_, integral_{0};
    double cos_{1}, sin_{0};
    double ahead_h_{-1}, ahead_cos_{1}, ahead_sin_{0}; ///< what ahead() has said since the last step; -1: nothing
};

// Here, so that a loop over many of them works on several at once: each is a long chain of operations.

inline std::pair<double, double> Pll::ahead(double h) {
    if (h == ahead_h_) {
        return {ahead_cos_, ahead_sin_};
    }
    double s, c;
    double const x = w_ * h;
    if (std::abs(x) < 0.5) [[likely]] {
        // By their series, exact to rounding there, without the library.
        double const y = x * x;
        s = x + x * y * (-1. / 6 + y * (1. / 120 + y * (-1. / 5040 + y * (1. / 362880 + y * (-1. / 39916800)))));
        c = 1 + y * (-1. / 2 +
                     y * (1. / 24 + y * (-1. / 720 + y * (1. / 40320 + y * (-1. / 3628800 + y * (1. / 479001600))))));
    } else {
        s = std::sin(x);
        c = std::cos(x);
    }
    ahead_h_ = h;
    ahead_cos_ = cos_ * c - sin_ * s;
    ahead_sin_ = sin_ * c + cos_ * s;
    return {ahead_cos_, ahead_sin_};
}

inline void Pll::step(double alpha, double beta, double size, double h) {
    auto const [c, s] = ahead(h);
    ahead_h_ = -1;
    double const length = 1.5 - 0.5 * (c * c + s * s); // back to 1, to first order
    cos_ = c * length;
    sin_ = s * length;
    double const error = size > kNoVoltage ? (beta * cos_ - alpha * sin_) / size : 0;
    double const most = kMaxOff * w0_;
    integral_ = std::clamp(integral_ + kIntegral * error * h, -most, most);
    w_ = w0_ + integral_ + kProportional * error;
}

} // namespace gridspace::sim::emt

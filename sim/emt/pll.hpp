// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

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
    /// After h seconds, with the space vector as it is now.
    void step(double alpha, double beta, double h);
    /// Cosine and sine of the angle that it will have h from now.
    [[nodiscard]] std::pair<double, double> ahead(double h) const;
    /// Runs on at nominal frequency from now.
    void rest() { integral_ = 0; }
    [[nodiscard]] double frequency_hz() const { return w_ / 6.283185307179586477; }

  private:
    double w0_, w_, integral_{0};
    double cos_{1}, sin_{0};
};

} // namespace gridspace::sim::emt

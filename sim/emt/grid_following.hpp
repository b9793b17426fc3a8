// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/emt/emt_machine.hpp"
#include "sim/emt/pll.hpp"

#include <array>
#include <complex>

namespace gridspace::sim::emt {

/// Averaged grid-following converter: a phase-locked loop, and a current control that reaches its reference with a
/// first-order lag. Photovoltaics, batteries and the part of a load that is not a constant impedance are such.
class GridFollowing {
  public:
    static constexpr double kCurrentLagS = 1e-3;
    static constexpr double kVoltageLagS = 5e-3;

    /// `max_peak_a`: of the current; 0: no limit.
    GridFollowing(double frequency_hz, double nominal_peak_v, double max_peak_a);

    /// Steady state at voltage phasor v (peak, phase a): the current phasor for a power (W, var) into the network.
    [[nodiscard]] std::complex<double> start(std::complex<double> v, std::complex<double> power);
    /// Filtered voltage at the terminals, p.u. of nominal.
    [[nodiscard]] double voltage_pu() const { return voltage_ / nominal_; }
    /// Phase currents into the network for a step that ends h from now.
    [[nodiscard]] std::array<double, 3> currents(double h) const;
    /// After the step, with its terminal voltage (V) and the power that is wanted from now on.
    void step(Space const& v, std::complex<double> power, double h);
    /// Blocks at once and for ever.
    void trip();
    [[nodiscard]] bool tripped() const { return tripped_; }

  private:
    [[nodiscard]] std::complex<double> reference(std::complex<double> power) const;
    Pll pll_;
    double nominal_, max_peak_a_;
    double voltage_{0};
    std::complex<double> current_; ///< in the frame of the loop
    bool tripped_{false};
};

} // namespace gridspace::sim::emt

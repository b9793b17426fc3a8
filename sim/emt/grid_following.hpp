// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/circuit/space.hpp"
#include "sim/emt/pll.hpp"

#include <array>
#include <complex>

namespace gridspace::sim::emt {

/// Averaged grid-following converter: a phase-locked loop, and a current control that reaches its reference with a
/// first-order lag. Photovoltaics, batteries and the part of a load that is not a constant impedance are such.
///
/// A source (`ceases`) does not feed a bus that no grid holds: outside of 0.5 to 1.2 p.u. or 10 % off nominal frequency
/// for 0.16 s it ceases to give current; when the voltage has been within 0.88 to 1.1 p.u. and the frequency within 1 %
/// for 0.2 s it comes back along a ramp of 0.4 s. (After the momentary cessation and the must-trip times of
/// IEEE 1547-2018, 6.4 and 6.5, categories II and III, with a short delay of return instead of the 300 s of its 4.10.)
class GridFollowing {
  public:
    static constexpr double kCurrentLagS = 1e-3;
    static constexpr double kVoltageLagS = 5e-3;

    /// `max_peak_a`: of the current; 0: no limit.
    GridFollowing(double frequency_hz, double nominal_peak_v, double max_peak_a, bool ceases = false);

    /// Steady state at voltage phasor v (peak, phase a): the current phasor for a power (W, var) into the network.
    [[nodiscard]] std::complex<double> start(std::complex<double> v, std::complex<double> power);
    /// Filtered voltage at the terminals, p.u. of nominal.
    [[nodiscard]] double voltage_pu() const { return voltage_ / nominal_; }
    /// Phase currents into the network for a step that ends h from now.
    [[nodiscard]] std::array<double, 3> currents(double h) const;
    /// After the step, with its terminal voltage (V) and the power that is wanted from now on.
    void step(Space const& v, std::complex<double> power, double h);
    /// Blocks at once, until resume().
    void trip();
    /// Back in service at voltage `v` (phasor as in start()): the current begins at zero, that of a source when it has
    /// seen a grid for as long as after a cessation.
    void resume(std::complex<double> v);
    [[nodiscard]] bool tripped() const { return tripped_; }
    /// Gives no current while it is told so. After that the current of a source comes back as after a cessation.
    void stand_by(bool on);
    /// Gives no current until there is a grid again.
    [[nodiscard]] bool ceased() const { return ceased_; }
    [[nodiscard]] double frequency_hz() const { return pll_.frequency_hz(); }

  private:
    void watch_grid(double h);
    void wait_for_grid();
    [[nodiscard]] std::complex<double> reference(std::complex<double> power) const;
    Pll pll_;
    double nominal_, max_peak_a_;
    double voltage_{0};
    std::complex<double> current_; ///< in the frame of the loop
    double frequency_hz_;
    bool ceases_{false}, ceased_{false}, tripped_{false}, stands_by_{false};
    double outside_s_{0}, inside_s_{0}; ///< for how long the grid has been unfit, or fit
    double share_{1};                   ///< of its current, while it comes back
};

} // namespace gridspace::sim::emt

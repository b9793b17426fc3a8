// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/circuit/space.hpp"
#include "sim/emt/grid_watch.hpp"
#include "sim/emt/pll.hpp"

#include <array>
#include <cmath>
#include <complex>
#include <memory>
#include <optional>

namespace gridspace::sim::emt {

/// Averaged grid-following converter: a phase-locked loop, and a current control that reaches its reference with a
/// first-order lag. Photovoltaics, batteries and the part of a load that is not a constant impedance are such.
///
/// A source has a GridWatch: it does not feed a bus that no grid holds, and comes back when there is one.
class GridFollowing {
  public:
    static constexpr double kCurrentLagS = 1e-3;
    static constexpr double kVoltageLagS = 5e-3;

    /// `max_peak_a`: of the current; 0: no limit.
    /// `rules`: of a source.
    GridFollowing(double frequency_hz, double nominal_peak_v, double max_peak_a, std::optional<GridRules> rules = {});

    /// Steady state at voltage phasor v (peak, phase a): the current phasor for a power (W, var) into the network.
    [[nodiscard]] std::complex<double> start(std::complex<double> v, std::complex<double> power);
    /// Filtered voltage at the terminals, p.u. of nominal.
    [[nodiscard]] double voltage_pu() const { return voltage_ / nominal_; }
    /// Phase currents into the network for a step that ends h from now.
    [[nodiscard]] std::array<double, 3> currents(double h) {
        auto const [c, s] = pll_.ahead(h);
        return to_phases({current_.real() * c - current_.imag() * s, current_.real() * s + current_.imag() * c, 0});
    }
    /// After the step, with its terminal voltage (V): what it measures; and then its control, with the power that is
    /// wanted from now on. Not while it is tripped.
    void measure(Space const& v, double h) {
        double const size = std::sqrt(v.alpha * v.alpha + v.beta * v.beta);
        pll_.step(v.alpha, v.beta, size, h);
        voltage_ += (size - voltage_) * h / (kVoltageLagS + h);
    }
    void control(std::complex<double> power, double h) { control(power, h, current_share(h)); }
    void control(std::complex<double> power, double h, double current_share);
    /// Of the way to its reference that a current goes in a step.
    [[nodiscard]] static double current_share(double h) { return h / (kCurrentLagS + h); }
    /// Blocks at once, until resume().
    void trip();
    /// Back in service at voltage `v` (phasor as in start()): the current begins at zero, that of a source when it has
    /// seen a grid for as long as after a cessation.
    void resume(std::complex<double> v);
    [[nodiscard]] bool tripped() const { return tripped_; }
    /// Gives no current while this is set. After that the current of a source comes back as after a cessation.
    void stand_by(bool on);
    /// Gives no current until there is a grid again.
    [[nodiscard]] bool ceased() const { return share() == 0; }
    /// Of the current that is wanted, 0 to 1.
    [[nodiscard]] double share() const { return watch_ ? watch_->share() : stands_by_ ? 0 : 1; }
    [[nodiscard]] double frequency_hz() const { return pll_.frequency_hz(); }

  private:
    [[nodiscard]] std::complex<double> reference(std::complex<double> power) const;
    // What a step of any converter reads stands together.
    Pll pll_;
    double nominal_, max_peak_a_;
    double voltage_{0};
    std::complex<double> current_; ///< in the frame of the loop
    double frequency_hz_;
    bool tripped_{false}, stands_by_{false};
    std::unique_ptr<GridWatch> watch_;
    std::optional<FrequencyShift> shift_;
};

} // namespace gridspace::sim::emt

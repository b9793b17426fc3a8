// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/circuit/circuit.hpp"
#include "sim/emt/past.hpp"

#include <array>
#include <complex>

namespace gridspace::sim::emt {

/// The waves on one line: what left each end, for as long as it travels. Modes are alpha, beta (positive sequence data)
/// and zero. i_k(t) = v_k(t)/Z + I_k, Z = Zc + R/4, h = (Zc - R/4)/Z, with F = v/Z + h i of a travel time ago: I_k =
/// -(1+h)/2 F_m - (1-h)/2 F_k  [Dommel, IEEE Trans. PAS-88(4), 1969, with the resistance lumped].
class BergeronWaves {
  public:
    BergeronWaves(BergeronLine const& line, double step_s);

    [[nodiscard]] PhaseMatrix conductance() const;
    /// Admittances of an end, and between the ends, in the steady state at angular frequency w.
    struct Steady {
        ComplexPhaseMatrix own, cross;
    };
    [[nodiscard]] Steady steady(double w) const;
    /// Fills the past of a steady state: phasors at both ends (from, to), voltages and currents into the line.
    using Phasors = std::array<std::array<std::complex<double>, 3>, 2>; ///< by end and phase
    void start(double w, Phasors const& v, Phasors const& i);

    /// Currents I of the phases of an end (0: from, 1: to) for a step that ends at t.
    void history(double t, std::size_t end, double* out) const;
    /// A step has ended at t; then, for each end, its voltages and currents.
    void open(double t);
    void leave(std::size_t end, double const* v, double const* i);

    /// Voltages and currents (towards `to`) at a share x of the length, at an instant of the past or t_now; the losses
    /// are taken as spread along the line.
    struct Inside {
        std::array<double, 3> v, i;
    };
    [[nodiscard]] Inside inside(double t, double x) const;
    /// Fills the past of a piece of another line, between shares x0 and x1 of its length.
    void continue_from(BergeronWaves const& whole, double t_now, double x0, double x1);

    /// For going back to an earlier instant.
    [[nodiscard]] std::size_t mark() const { return past_.mark(); }
    void back_to(std::size_t mark) { past_.back_to(mark); }

  private:
    struct Wave {
        double t{0};
        std::array<std::array<double, 3>, 2> f{}, i{}; ///< by end and mode: what left, and the current
    };
    struct Found {
        double f{0}, i{0};
    };
    [[nodiscard]] Found find(double t, std::size_t end, std::size_t mode) const;
    [[nodiscard]] double at(double t, std::size_t end, std::size_t mode) const { return find(t, end, mode).f; }
    std::array<double, 3> z_, h_, tau_; ///< by mode
    std::array<double, 3> surge_, r_;   ///< by mode: surge impedance, resistance
    double step_s_;
    Past<Wave> past_;
};

} // namespace gridspace::sim::emt

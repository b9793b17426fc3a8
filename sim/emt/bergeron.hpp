// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/emt/circuit.hpp"

#include <array>
#include <complex>
#include <vector>

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
    /// Fills the past of a steady state: phasors of phase a at both ends (from, to), voltages and currents into the
    /// line.
    void start(double w, std::array<std::complex<double>, 2> const& v, std::array<std::complex<double>, 2> const& i);

    /// Currents I of both ends (3 phases each, from then to) for a step that ends at t.
    void history(double t, double* out) const;
    /// After a step that ended at t: voltages and currents of both ends.
    void leave(double t, double const* v, double const* i);

    /// For going back to an earlier instant.
    [[nodiscard]] std::size_t mark() const { return written_; }
    void back_to(std::size_t mark) { written_ = mark; }

  private:
    struct Wave {
        double t{0};
        std::array<std::array<double, 3>, 2> f{}; ///< by end and mode
    };
    [[nodiscard]] double at(double t, std::size_t end, std::size_t mode) const;
    std::array<double, 3> z_, h_, tau_; ///< by mode
    double step_s_;
    std::vector<Wave> past_; ///< ring
    std::size_t written_{0};
};

} // namespace gridspace::sim::emt

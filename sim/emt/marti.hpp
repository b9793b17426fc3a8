// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/circuit/circuit.hpp"
#include "sim/circuit/norton.hpp"
#include "sim/emt/past.hpp"

#include <array>
#include <complex>
#include <vector>

namespace gridspace::sim::emt {

/// A pole sum as a recursion: each term x' = decay x + fresh u' + past u [recursive convolution, Semlyen and Dabuleanu,
/// IEEE Trans. PAS-94(2), 1975].
struct PoleRecursion {
    double direct{0};
    std::vector<double> decay, fresh, past;

    /// Exact for inputs that are straight between steps.
    static PoleRecursion straight(PoleSum const& f, double h);
    /// Half a step of h whose `fresh` is that of the whole one, as in backward Euler steps: the decay and constant
    /// inputs are exact.
    static PoleRecursion damped_half(PoleSum const& f, double h);
    /// What the newest input counts.
    [[nodiscard]] double gain() const;
    /// What it makes of exp(j w t), with steps of h.
    [[nodiscard]] std::complex<double> at(double w, double h) const;
};

/// What a frequency-dependent line needs for steps of one length; modes are the positive and the zero sequence.
struct MartiStep {
    struct Mode {
        PoleRecursion impedance, impedance_half, propagation, propagation_half;
        double gain{0}; ///< of the impedance: ohm between its newest current and voltage
    };
    std::array<Mode, 2> modes;

    MartiStep(MartiLine const& line, double h);
    [[nodiscard]] PhaseMatrix conductance() const;
};

/// The waves on one line. With F = v + Zc i leaving an end and B = A F of the other end arriving: v = Zc i + B, and
/// F = 2 v - B. F passes through A without its delay when it leaves, and then travels.
class MartiWaves {
  public:
    MartiWaves(MartiLine const& line, double step_s);

    /// Admittances of an end, and between the ends, of these recursions in steps of their h at angular frequency w.
    struct Steady {
        ComplexPhaseMatrix own, cross;
    };
    [[nodiscard]] Steady steady(MartiStep const& step, double w) const;
    /// Fills states and past of a steady state: phasors at both ends (from, to), voltages and currents into the line.
    using Phasors = std::array<std::array<std::complex<double>, 3>, 2>; ///< by end and phase
    void start(MartiStep const& step, double w, Phasors const& v, Phasors const& i);

    /// Current of an end without its conductance (3 phases) for a step that ends at t.
    void history(MartiStep const& step, Rule rule, double t, std::size_t end, double* out);
    /// After a step that ended at t: open(t), then voltages and currents of each end. Two threads may have an end each.
    void open(double t) { past_.next().t = t; }
    void leave(MartiStep const& step, Rule rule, std::size_t end, double const* v, double const* i);

    void save();
    void restore();

  private:
    struct Wave {
        double t{0};
        std::array<std::array<double, 3>, 2> g{}; ///< by end and mode: what travels
    };
    /// By end and mode: terms of impedance and propagation, and their last inputs.
    struct End {
        std::vector<double> impedance, propagation;
        double i{0}, f{0};
    };
    using Ends = std::array<std::array<End, 3>, 2>;
    [[nodiscard]] std::complex<double> travel(std::size_t mode, double w) const;

    std::array<double, 3> tau_; ///< by mode
    double step_s_;
    Ends now_, saved_;
    std::array<std::array<double, 3>, 2> arriving_{}; ///< B of the step that is being taken
    Past<Wave> past_;
    std::size_t mark_{0};
};

} // namespace gridspace::sim::emt

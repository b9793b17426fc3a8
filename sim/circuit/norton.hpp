// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/circuit/phase_matrix.hpp"
#include "sim/engine/engine.hpp"

#include <array>
#include <complex>
#include <optional>
#include <string_view>
#include <vector>

namespace gridspace::sim {

/// A turning mass: what the mean frequency of a system weighs.
struct Rotor {
    double inertia_kws{0}; ///< H times rating
    double frequency_hz{0};
};

} // namespace gridspace::sim

namespace gridspace::sim::emt {

/// How a step integrates.
enum class Rule { trapezoid, backward_euler };

/// An element with states of its own between three phases and earth, as the nodal equations see it: a conductance that
/// is constant for a step of a given length, and a current that it predicts, corrects once the voltages are known, and
/// accepts. A voltage behind an impedance is one: a synchronous or induction machine, a grid-forming converter. Volts
/// and amperes (peak, phases a, b, c), currents into the network. Steps allocate nothing.
class NortonElement {
  public:
    virtual ~NortonElement() = default;

    /// Conductance of a step of `h` (a backward Euler step of h/2 has the same), siemens.
    [[nodiscard]] virtual PhaseMatrix conductance(double h) const = 0;
    /// The same in the steady state; `speed`: what the trapezoidal rule makes of nominal angular frequency, p.u.
    [[nodiscard]] virtual ComplexPhaseMatrix steady_admittance(double speed) const = 0;
    /// The steady state with terminal voltage v and current i, phasors of the positive sequence.
    virtual void start(std::complex<double> v, std::complex<double> i, double speed) = 0;
    /// Then, in an unbalanced network: voltages and currents of the phases at t = 0. Between them and the positive
    /// sequence lies what steady_admittance() says of the others.
    virtual void start_unbalanced(std::array<double, 3> const& v, std::array<double, 3> const& i) = 0;
    /// Whether it can start so; the error names the element.
    [[nodiscard]] virtual Result<void> check_start() const { return {}; }

    /// Coefficients of a step h, before predict().
    virtual void use_step(double h) = 0;
    /// Slopes of before a discontinuity are not extrapolated beyond it.
    virtual void forget_history() {}
    /// The current for a step that ends at `t` and lasts `h` (its own length).
    [[nodiscard]] virtual std::array<double, 3> predict(double t, double h, Rule rule) = 0;
    /// How often correct() is asked in a step.
    [[nodiscard]] virtual int corrections() const { return 1; }
    /// The change of that current for terminal voltages v.
    [[nodiscard]] virtual std::array<double, 3> correct(double const* v) = 0;
    /// The step is done, with terminal voltages v.
    virtual void finish(double const* v) = 0;
    /// Keeps what a step changes, and goes back to it.
    virtual void save() = 0;
    virtual void restore() = 0;
    /// False when it has left what its equations describe; false for NaN. failure() says what happened.
    [[nodiscard]] virtual bool sound() const { return true; }
    [[nodiscard]] virtual Error failure(double /*t*/) const { return {}; }

    [[nodiscard]] virtual double current_a(int phase) const = 0;
    [[nodiscard]] virtual std::optional<Rotor> rotor() const { return {}; }
    /// Signals, without the name of the element, and their values.
    [[nodiscard]] virtual std::vector<SignalDef> signals() const { return {}; }
    [[nodiscard]] virtual double value(std::size_t /*signal*/) const { return 0; }
    /// Changes a quantity in a run; false when it cannot have this value.
    virtual bool set(std::string_view /*quantity*/, double /*value*/) { return false; }
    /// One of the modes of its kind, from now on.
    virtual void set_mode(std::string_view /*mode*/) {}
    /// Back from standing by, with open poles so far, at time t and a bus voltage v (phasor as in start(); 0: dead).
    virtual void resume(double /*t*/, std::complex<double> /*v*/) {}
};

} // namespace gridspace::sim::emt

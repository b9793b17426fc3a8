// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/emt/circuit.hpp"
#include "sim/machines/synchronous_machine.hpp"

#include <complex>

namespace gridspace::sim::emt {

/// alpha, beta (space vector of phase peaks) and zero sequence.
struct Space {
    double alpha{0}, beta{0}, zero{0};
};
[[nodiscard]] inline Space to_space(double a, double b, double c) {
    constexpr double kInverseRoot3 = 0.57735026918962576451;
    return {(2 * a - b - c) / 3, (b - c) * kInverseRoot3, (a + b + c) / 3};
}
[[nodiscard]] inline std::array<double, 3> to_phases(Space const& s) {
    constexpr double kHalfRoot3 = 0.86602540378443864676;
    return {s.alpha + s.zero, -s.alpha / 2 + kHalfRoot3 * s.beta + s.zero, -s.alpha / 2 - kHalfRoot3 * s.beta + s.zero};
}

/// A synchronous machine as the nodal equations see it: a constant conductance and a current. The stator is solved as
/// v + ra i = d(psi)/dt / w0 with psi = psi'' - x'' i, by the same rule as the network; the rotor by Adams-Bashforth
/// and one trapezoidal correction, after which the network is solved again (docs/design/emt.md).
class EmtMachine {
  public:
    enum class Rule { trapezoid, backward_euler };

    EmtMachine(MachinePort const& port, double frequency_hz);

    /// Conductance of a step of `h` (a backward Euler step of h/2 has the same), siemens.
    [[nodiscard]] PhaseMatrix conductance(double h) const;
    /// Coefficients of a step h, before predict().
    void use_step(double h);

    /// Positive sequence phasors at the terminals, p.u., current out of the machine; `speed`: see
    /// machines::steady_state.
    void start(std::complex<double> v, std::complex<double> i, double speed);
    /// Derivatives of before a discontinuity are not extrapolated beyond it.
    void forget_history() { history_ = false; }

    /// The current into the network, A, for a step that ends at `t` and lasts `h` (its own length).
    [[nodiscard]] std::array<double, 3> predict(double t, double h, Rule rule);
    /// The change of that current for terminal voltages v (V).
    [[nodiscard]] std::array<double, 3> correct(double const* v);
    /// The step is done, with terminal voltages v (V).
    void finish(double const* v);

    [[nodiscard]] machines::State const& state() const { return x_; }
    machines::Setpoints& setpoints() { return set_; }
    [[nodiscard]] machines::MachineData const& data() const { return data_; }
    machines::MachineData& data() { return data_; }
    [[nodiscard]] double frequency_hz() const { return (1 + x_[machines::kSpeed]) * w0_ / 6.283185307179586477; }
    [[nodiscard]] double torque_pu() const { return machines::torque(data_, x_, id_, iq_); }
    /// Terminal powers, p.u., instantaneous.
    [[nodiscard]] std::complex<double> power_pu() const;
    [[nodiscard]] double voltage_pu() const { return vt_; }
    /// Current of a phase into the network, A.
    [[nodiscard]] double current_a(int phase) const { return to_phases(i_)[static_cast<std::size_t>(phase)] * i_base_; }

  private:
    void rotate(double& d, double& q) const; ///< alpha, beta currents i_ of the trial step to the rotor frame
    machines::MachineData data_;
    machines::Setpoints set_;
    double w0_, v_base_, i_base_;
    // coefficients of the step
    double k_{0}, gs_{0}, g0_{0};
    // accepted state
    machines::State x_{}, f_{}, f_before_{};
    double h_before_{0};
    bool history_{false};
    Space v_, i_;
    double psi_alpha_{0}, psi_beta_{0}; ///< psi'' in the standing frame
    double id_{0}, iq_{0}, vt_{0};
    // trial step
    machines::State trial_{};
    double h_{0}, cos_{1}, sin_{0};
    Space source_; ///< Norton current, p.u.
    double trial_psi_alpha_{0}, trial_psi_beta_{0};
};

} // namespace gridspace::sim::emt

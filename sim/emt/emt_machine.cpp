// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/emt_machine.hpp"

#include <cmath>
#include <numbers>

namespace gridspace::sim::emt {

using machines::State;

EmtMachine::EmtMachine(MachinePort const& port, double frequency_hz)
    : data_{port.data}, w0_{2 * std::numbers::pi * frequency_hz}, v_base_{port.v_base}, i_base_{port.i_base} {}

PhaseMatrix EmtMachine::conductance(double h) const {
    double const k = 2 / (h * w0_);
    double const scale = i_base_ / v_base_;
    double const zero = data_.x0 > 0 ? 1 / (data_.ra + k * data_.x0) : 0;
    return PhaseMatrix::sequence(scale / (data_.ra + k * data_.x2()), scale * zero);
}

void EmtMachine::use_step(double h) {
    k_ = 2 / (h * w0_);
    gs_ = 1 / (data_.ra + k_ * data_.x2());
    g0_ = data_.x0 > 0 ? 1 / (data_.ra + k_ * data_.x0) : 0;
}

void EmtMachine::start(std::complex<double> v, std::complex<double> i, double speed) {
    auto const start = machines::steady_state(data_, v, i, speed);
    x_ = start.x;
    set_ = start.set;
    v_ = {v.real(), v.imag(), 0};
    i_ = {i.real(), i.imag(), 0};
    vt_ = std::abs(v);
    double const axis = x_[machines::kAngle] - std::numbers::pi / 2;
    cos_ = std::cos(axis);
    sin_ = std::sin(axis);
    rotate(id_, iq_);
    auto const flux = machines::subtransient_flux(data_, x_, id_, iq_);
    psi_alpha_ = flux.d * cos_ - flux.q * sin_;
    psi_beta_ = flux.d * sin_ + flux.q * cos_;
    machines::derivative(data_, set_, x_, id_, iq_, vt_, f_);
    f_[machines::kAngle] = w0_ * x_[machines::kSpeed];
    history_ = false;
}

void EmtMachine::rotate(double& d, double& q) const {
    d = i_.alpha * cos_ + i_.beta * sin_;
    q = -i_.alpha * sin_ + i_.beta * cos_;
}

std::array<double, 3> EmtMachine::predict(double t, double h, Rule rule) {
    h_ = h;
    double const slope = history_ ? h * h / (2 * h_before_) : 0;
    for (std::size_t s = 0; s < machines::kStates; ++s) {
        trial_[s] = x_[s] + h * f_[s] + slope * (f_[s] - f_before_[s]);
    }
    double const axis = std::fmod(w0_ * t, 2 * std::numbers::pi) + trial_[machines::kAngle] - std::numbers::pi / 2;
    cos_ = std::cos(axis);
    sin_ = std::sin(axis);
    auto const flux = machines::subtransient_flux(data_, trial_, id_, iq_);
    trial_psi_alpha_ = flux.d * cos_ - flux.q * sin_;
    trial_psi_beta_ = flux.d * sin_ + flux.q * cos_;
    double const kx = k_ * data_.x2(), kx0 = k_ * data_.x0;
    double const past_alpha = kx * i_.alpha + k_ * (trial_psi_alpha_ - psi_alpha_);
    double const past_beta = kx * i_.beta + k_ * (trial_psi_beta_ - psi_beta_);
    if (rule == Rule::trapezoid) {
        source_.alpha = gs_ * (past_alpha - v_.alpha - data_.ra * i_.alpha);
        source_.beta = gs_ * (past_beta - v_.beta - data_.ra * i_.beta);
        source_.zero = g0_ * (kx0 * i_.zero - v_.zero - data_.ra * i_.zero);
    } else {
        source_.alpha = gs_ * past_alpha;
        source_.beta = gs_ * past_beta;
        source_.zero = g0_ * kx0 * i_.zero;
    }
    auto const j = to_phases(source_);
    return {j[0] * i_base_, j[1] * i_base_, j[2] * i_base_};
}

std::array<double, 3> EmtMachine::correct(double const* v) {
    Space const volts = to_space(v[0], v[1], v[2]);
    double const va = volts.alpha / v_base_, vb = volts.beta / v_base_;
    double const ia = source_.alpha - gs_ * va, ib = source_.beta - gs_ * vb;
    double const d = ia * cos_ + ib * sin_, q = -ia * sin_ + ib * cos_;
    State f;
    machines::derivative(data_, set_, trial_, d, q, std::sqrt(va * va + vb * vb), f);
    f[machines::kAngle] = w0_ * trial_[machines::kSpeed];
    double const predicted_angle = trial_[machines::kAngle];
    for (std::size_t s = 0; s < machines::kStates; ++s) {
        trial_[s] = x_[s] + h_ / 2 * (f_[s] + f[s]);
    }
    // The correction of the angle is tiny: second order in it is exact to rounding.
    double const e = trial_[machines::kAngle] - predicted_angle;
    double const c = cos_ * (1 - e * e / 2) - sin_ * e;
    sin_ = sin_ * (1 - e * e / 2) + cos_ * e;
    cos_ = c;
    auto const flux = machines::subtransient_flux(data_, trial_, d, q);
    double const alpha = flux.d * cos_ - flux.q * sin_, beta = flux.d * sin_ + flux.q * cos_;
    Space const change{gs_ * k_ * (alpha - trial_psi_alpha_), gs_ * k_ * (beta - trial_psi_beta_), 0};
    trial_psi_alpha_ = alpha;
    trial_psi_beta_ = beta;
    source_.alpha += change.alpha;
    source_.beta += change.beta;
    auto const j = to_phases(change);
    return {j[0] * i_base_, j[1] * i_base_, j[2] * i_base_};
}

void EmtMachine::finish(double const* v) {
    Space const volts = to_space(v[0], v[1], v[2]);
    v_ = {volts.alpha / v_base_, volts.beta / v_base_, volts.zero / v_base_};
    i_ = {source_.alpha - gs_ * v_.alpha, source_.beta - gs_ * v_.beta, source_.zero - g0_ * v_.zero};
    vt_ = std::sqrt(v_.alpha * v_.alpha + v_.beta * v_.beta);
    rotate(id_, iq_);
    machines::limit(data_, set_, vt_, trial_);
    x_ = trial_;
    f_before_ = f_;
    machines::derivative(data_, set_, x_, id_, iq_, vt_, f_);
    f_[machines::kAngle] = w0_ * x_[machines::kSpeed];
    h_before_ = h_;
    history_ = true;
    psi_alpha_ = trial_psi_alpha_;
    psi_beta_ = trial_psi_beta_;
}

std::complex<double> EmtMachine::power_pu() const {
    return {v_.alpha * i_.alpha + v_.beta * i_.beta, v_.beta * i_.alpha - v_.alpha * i_.beta};
}

} // namespace gridspace::sim::emt

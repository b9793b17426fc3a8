// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/circuit/space.hpp"
#include "sim/components/machine/machine_checks.hpp"
#include "sim/components/machine/rotor_equations.hpp"

#include "common/text.hpp"

#include <cmath>
#include <fmt/format.h>
#include <numbers>

/// A synchronous machine in the waveform simulation: v + ra i = d(psi)/dt / w0 with psi = psi'' - x'' i in the stator,
/// by the same rule as the network; the rotor by Adams-Bashforth and one trapezoidal correction, after which the
/// network is solved again (docs/design/emt.md).
namespace gridspace::sim {
namespace {

using emt::PhaseMatrix;
using emt::Rule;
using emt::Space;
using emt::to_phases;
using emt::to_space;

/// A machine this far from nominal speed (p.u.) has left what its equations describe.
constexpr double kRunaway = 5;

/// What a step changes. p.u.
struct MachineDynamics {
    machines::Setpoints set_;
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

class MachineElement final : public emt::NortonElement, private MachineDynamics {
  public:
    MachineElement(Machine const& machine, CircuitFace const& face)
        : name_{machine.name.name}, data_{machines::machine_data(machine, face)}, w0_{face.omega()},
          v_base_{face.peak_v(machine.bus)}, i_base_{2 * machine.rating_kva * 1e3 / (3 * v_base_)}, p_kw_{machine.p_kw},
          voltage_setpoint_pu_{machine.voltage_setpoint_pu} {}

    [[nodiscard]] PhaseMatrix conductance(double h) const override;
    [[nodiscard]] emt::ComplexPhaseMatrix steady_admittance(double speed) const override;
    void start(Complex v, Complex i, double speed) override;
    void start_unbalanced(std::array<double, 3> const& v, std::array<double, 3> const& i) override;
    [[nodiscard]] Result<void> check_start() const override {
        auto const ok = machines::check_gate(name_, data_, x_[machines::kGate]);
        return ok ? machines::check_field(name_, data_, x_) : ok;
    }
    void use_step(double h) override;
    void forget_history() override { history_ = false; }
    [[nodiscard]] std::array<double, 3> predict(double t, double h, Rule rule) override;
    /// Where the subtransient reactances of the axes differ, the flux behind their mean follows the current itself.
    [[nodiscard]] int corrections() const override { return data_.round_subtransient() ? 1 : 3; }
    [[nodiscard]] std::array<double, 3> correct(double const* v) override;
    void finish(double const* v) override;
    void save() override { saved_ = static_cast<MachineDynamics const&>(*this); }
    void restore() override { static_cast<MachineDynamics&>(*this) = saved_; }
    [[nodiscard]] bool sound() const override { return std::abs(x_[machines::kSpeed]) < kRunaway; } // false for NaN
    [[nodiscard]] Error failure(double t) const override;
    [[nodiscard]] double current_a(int phase) const override {
        return to_phases(i_)[static_cast<std::size_t>(phase)] * i_base_;
    }
    [[nodiscard]] std::optional<Rotor> rotor() const override {
        return Rotor{data_.h * data_.rating_kva, frequency_hz()};
    }
    [[nodiscard]] std::vector<SignalDef> signals() const override;
    [[nodiscard]] double value(std::size_t signal) const override;
    bool set(std::string_view quantity, double value) override;
    void set_mode(std::string_view mode) override { set_.governor = machines::governor_mode(mode); }

  private:
    void follow_terminals();
    void rotate(double& d, double& q) const; ///< alpha, beta currents i_ of the trial step to the rotor frame
    [[nodiscard]] double frequency_hz() const { return (1 + x_[machines::kSpeed]) * w0_ / 6.283185307179586477; }
    std::string name_;
    machines::MachineData data_;
    double w0_, v_base_, i_base_; ///< bases: peak phase values
    double p_kw_, voltage_setpoint_pu_;
    MachineDynamics saved_;
};

PhaseMatrix MachineElement::conductance(double h) const {
    double const k = 2 / (h * w0_);
    double const scale = i_base_ / v_base_;
    double const zero = data_.x0 > 0 ? 1 / (data_.ra + k * data_.x0) : 0;
    return PhaseMatrix::sequence(scale / (data_.ra + k * data_.x2()), scale * zero);
}

emt::ComplexPhaseMatrix MachineElement::steady_admittance(double speed) const {
    double const scale = i_base_ / v_base_;
    Complex const zero = data_.x0 > 0 ? 1.0 / Complex{data_.ra, speed * data_.x0} : Complex{};
    return emt::ComplexPhaseMatrix::sequence(scale / Complex{data_.ra, speed * data_.x2()}, scale * zero);
}

void MachineElement::use_step(double h) {
    k_ = 2 / (h * w0_);
    gs_ = 1 / (data_.ra + k_ * data_.x2());
    g0_ = data_.x0 > 0 ? 1 / (data_.ra + k_ * data_.x0) : 0;
}

void MachineElement::start(Complex volts, Complex amperes, double speed) {
    Complex const v = volts / v_base_, i = amperes / i_base_;
    auto const start = machines::steady_state(data_, v, i, speed);
    x_ = start.x;
    set_ = start.set;
    v_ = {v.real(), v.imag(), 0};
    i_ = {i.real(), i.imag(), 0};
    vt_ = std::abs(v);
    double const axis = x_[machines::kAngle] - std::numbers::pi / 2;
    cos_ = std::cos(axis);
    sin_ = std::sin(axis);
    follow_terminals();
    history_ = false;
}

/// Fluxes and slopes at the start, from voltage and current there.
void MachineElement::follow_terminals() {
    rotate(id_, iq_);
    auto const flux = machines::subtransient_flux(data_, x_, id_, iq_);
    psi_alpha_ = flux.d * cos_ - flux.q * sin_;
    psi_beta_ = flux.d * sin_ + flux.q * cos_;
    machines::derivative(data_, set_, x_, id_, iq_, vt_, f_);
    f_[machines::kAngle] = w0_ * x_[machines::kSpeed];
}

/// The fluxes of the rotor are those of the positive sequence: their ripple at twice the frequency is yet to come.
void MachineElement::start_unbalanced(std::array<double, 3> const& volts, std::array<double, 3> const& amperes) {
    Space const v = to_space(volts[0], volts[1], volts[2]), i = to_space(amperes[0], amperes[1], amperes[2]);
    v_ = {v.alpha / v_base_, v.beta / v_base_, v.zero / v_base_};
    i_ = {i.alpha / i_base_, i.beta / i_base_, i.zero / i_base_};
    vt_ = std::hypot(v_.alpha, v_.beta);
    follow_terminals();
}

void MachineElement::rotate(double& d, double& q) const {
    d = i_.alpha * cos_ + i_.beta * sin_;
    q = -i_.alpha * sin_ + i_.beta * cos_;
}

std::array<double, 3> MachineElement::predict(double t, double h, Rule rule) {
    h_ = h;
    double const slope = history_ ? h * h / (2 * h_before_) : 0;
    for (std::size_t s = 0; s < data_.states; ++s) {
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

std::array<double, 3> MachineElement::correct(double const* v) {
    Space const volts = to_space(v[0], v[1], v[2]);
    double const va = volts.alpha / v_base_, vb = volts.beta / v_base_;
    double const ia = source_.alpha - gs_ * va, ib = source_.beta - gs_ * vb;
    double const d = ia * cos_ + ib * sin_, q = -ia * sin_ + ib * cos_;
    machines::State f;
    machines::derivative(data_, set_, trial_, d, q, std::sqrt(va * va + vb * vb), f);
    f[machines::kAngle] = w0_ * trial_[machines::kSpeed];
    double const predicted_angle = trial_[machines::kAngle];
    for (std::size_t s = 0; s < data_.states; ++s) {
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

void MachineElement::finish(double const* v) {
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

Error MachineElement::failure(double t) const {
    return {ExitCode::usage,
            fmt::format("machine '{}' runs away at {} s: its speed is {} p.u.", name_, shortest(t),
                        shortest(1 + x_[machines::kSpeed])),
            "nothing brakes or drives it any more; look at its governor, its inertia and what it feeds"};
}

bool MachineElement::set(std::string_view quantity, double value) {
    if (quantity == "p_kw") {
        set_.p_ref += (value - p_kw_) / data_.rating_kva;
        p_kw_ = value;
    } else if (quantity == "voltage_setpoint_pu") {
        set_.v_ref += value - voltage_setpoint_pu_;
        voltage_setpoint_pu_ = value;
    } else if (!data_.governor) {
        return false;
    } else if (quantity == "frequency_setpoint_hz") {
        set_.w_ref = value * 2 * std::numbers::pi / w0_ - 1;
    } else {
        data_.governor->droop_percent = value;
    }
    return true;
}

std::vector<SignalDef> MachineElement::signals() const {
    return {{"frequency_hz", "Hz"},  {"speed_pu", "p.u."}, {"angle_deg", "deg"}, {"torque_pu", "p.u."},
            {"v_pu", "p.u."},        {"efd_pu", "p.u."},   {"p_kw", "kW"},       {"q_kvar", "kvar"},
            {"mechanical_kw", "kW"}, {"i.a", "A"},         {"i.b", "A"},         {"i.c", "A"}};
}

double MachineElement::value(std::size_t signal) const {
    switch (signal) {
    case 0:
        return frequency_hz();
    case 1:
        return 1 + x_[machines::kSpeed];
    case 2:
        return x_[machines::kAngle] * (180 / std::numbers::pi);
    case 3:
        return machines::torque(data_, x_, id_, iq_);
    case 4:
        return vt_;
    case 5:
        return machines::field_voltage(data_, x_, id_, vt_);
    case 6: // instantaneous, at the terminals
        return (v_.alpha * i_.alpha + v_.beta * i_.beta) * data_.rating_kva;
    case 7:
        return (v_.beta * i_.alpha - v_.alpha * i_.beta) * data_.rating_kva;
    case 8:
        return machines::mechanical_power(data_, x_) * data_.rating_kva;
    default:
        return current_a(static_cast<int>(signal) - 9);
    }
}

} // namespace

void Machine::circuit(CircuitFace& face) const {
    face.norton(*this, std::make_shared<MachineElement>(*this, face));
}

} // namespace gridspace::sim

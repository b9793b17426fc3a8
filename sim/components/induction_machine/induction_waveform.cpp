// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/circuit/space.hpp"
#include "sim/components/induction_machine/induction_equations.hpp"

#include "common/text.hpp"

#include <cmath>
#include <fmt/format.h>
#include <numbers>

/// An induction machine in the waveform simulation: v = rs i + psi' / w0 in the stator, by the same rule as the
/// network; the rotor by Adams-Bashforth and one trapezoidal correction, after which the network is solved again.
namespace gridspace::sim {
namespace {

using emt::PhaseMatrix;
using emt::Rule;
using emt::Space;
using emt::to_phases;
using emt::to_space;

constexpr double kInductionRunaway = 5; ///< p.u. of speed
/// Of the insulation, p.u.: what holds the star point of a machine behind open poles.
constexpr double kInsulation = 1e-6;

/// What a step changes. p.u.; currents into the machine, fluxes and currents in the standing frame.
struct Dynamics {
    induction::State x_{}, f_{}, f_before_{};
    double h_before_{0};
    bool history_{false};
    double k_{0}, g_{0};
    Complex v_, i_, flux_;
    double v_zero_{0};
    // trial step
    induction::State trial_{};
    double h_{0};
    Complex axis_{1}, source_, trial_flux_;
};

class InductionElement final : public emt::NortonElement, private Dynamics {
  public:
    InductionElement(InductionMachine const& machine, CircuitFace const& face)
        : machine_{machine}, w0_{face.omega()}, v_base_{face.peak_v(machine.bus)},
          i_base_{2 * machine.rating_kva * 1e3 / (3 * v_base_)} {}

    [[nodiscard]] PhaseMatrix conductance(double h) const override {
        double const scale = i_base_ / v_base_;
        return PhaseMatrix::sequence(scale / (r() + 2 / (h * w0_) * x2()), scale * kInsulation);
    }
    [[nodiscard]] emt::ComplexPhaseMatrix steady_admittance(double speed) const override {
        double const scale = i_base_ / v_base_;
        return emt::ComplexPhaseMatrix::sequence(scale / Complex{r(), speed * x2()}, scale * kInsulation);
    }
    void start(Complex volts, Complex amperes, double speed) override {
        Complex const v = volts / v_base_;
        x_ = machine_.steady_state(v, speed);
        bool const turns = machine_.running_at_start();
        v_ = turns ? v : Complex{};
        i_ = turns ? -amperes / i_base_ : Complex{};
        v_zero_ = 0;
        start_v_ = std::abs(v);
        flux_ = machine_.flux(x_);
        machine_.derivative(x_, i_, w0_, f_);
        history_ = false;
    }
    void start_unbalanced(std::array<double, 3> const& volts, std::array<double, 3> const& amperes) override {
        if (machine_.running_at_start()) {
            emt::Space const v = emt::to_space(volts[0], volts[1], volts[2]),
                             i = emt::to_space(amperes[0], amperes[1], amperes[2]);
            v_ = Complex{v.alpha, v.beta} / v_base_;
            i_ = -Complex{i.alpha, i.beta} / i_base_;
            v_zero_ = v.zero / v_base_;
            machine_.derivative(x_, i_, w0_, f_);
        }
    }
    [[nodiscard]] Result<void> check_start() const override { return machine_.check_start(start_v_); }
    void use_step(double h) override {
        k_ = 2 / (h * w0_);
        g_ = 1 / (r() + k_ * x2());
    }
    void forget_history() override { history_ = false; }
    [[nodiscard]] std::array<double, 3> predict(double t, double h, Rule rule) override;
    [[nodiscard]] std::array<double, 3> correct(double const* v) override;
    void finish(double const* v) override;
    void save() override { saved_ = static_cast<Dynamics const&>(*this); }
    void restore() override { static_cast<Dynamics&>(*this) = saved_; }
    [[nodiscard]] bool sound() const override {
        return std::abs(x_[induction::kSpeed]) < kInductionRunaway;
    } // false for NaN
    [[nodiscard]] Error failure(double t) const override {
        return {ExitCode::usage,
                fmt::format("induction machine '{}' runs away at {} s: its speed is {} p.u.", machine_.name(),
                            shortest(t), shortest(x_[induction::kSpeed])),
                "look at its load_kw and its inertia_h_s"};
    }
    [[nodiscard]] double current_a(int phase) const override {
        return to_phases({-i_.real(), -i_.imag(), -kInsulation * v_zero_})[static_cast<std::size_t>(phase)] * i_base_;
    }
    [[nodiscard]] std::vector<SignalDef> signals() const override { return induction::signals(); }
    [[nodiscard]] double value(std::size_t index) const override {
        return induction::signal(index, machine_, x_, i_ * std::conj(axis_));
    }
    bool set(std::string_view, double value) override {
        machine_.set_load_kw(value);
        return true;
    }

  private:
    [[nodiscard]] double r() const { return machine_.resistance(); }
    [[nodiscard]] double x2() const { return machine_.subtransient_reactance(); }
    [[nodiscard]] Complex volts(double const* v) const {
        Space const s = to_space(v[0], v[1], v[2]);
        return Complex{s.alpha, s.beta} / v_base_;
    }
    [[nodiscard]] std::array<double, 3> amperes(Complex into_network) const {
        auto const i = to_phases({into_network.real(), into_network.imag(), 0});
        return {i[0] * i_base_, i[1] * i_base_, i[2] * i_base_};
    }
    induction::Machine machine_;
    double w0_, v_base_, i_base_; ///< bases: peak phase values
    double start_v_{0};
    Dynamics saved_;
};

std::array<double, 3> InductionElement::predict(double t, double h, Rule rule) {
    h_ = h;
    double const slope = history_ ? h * h / (2 * h_before_) : 0;
    for (std::size_t s = 0; s < x_.size(); ++s) {
        trial_[s] = x_[s] + h * f_[s] + slope * (f_[s] - f_before_[s]);
    }
    axis_ = std::polar(1.0, std::fmod(w0_ * t, 2 * std::numbers::pi));
    trial_flux_ = machine_.flux(trial_) * axis_;
    // (rs + k x'') i = v + past, with k = 2 / (h w0)
    Complex past = k_ * x2() * i_ - k_ * (trial_flux_ - flux_);
    if (rule == Rule::trapezoid) {
        past += v_ - r() * i_;
    }
    source_ = -g_ * past;
    return amperes(source_);
}

std::array<double, 3> InductionElement::correct(double const* v) {
    Complex const i = g_ * volts(v) - source_;
    induction::State f{};
    machine_.derivative(trial_, i * std::conj(axis_), w0_, f);
    for (std::size_t s = 0; s < x_.size(); ++s) {
        trial_[s] = x_[s] + h_ / 2 * (f_[s] + f[s]);
    }
    Complex const flux = machine_.flux(trial_) * axis_, change = g_ * k_ * (flux - trial_flux_);
    trial_flux_ = flux;
    source_ += change;
    return amperes(change);
}

void InductionElement::finish(double const* v) {
    v_ = volts(v);
    v_zero_ = to_space(v[0], v[1], v[2]).zero / v_base_;
    i_ = g_ * v_ - source_;
    x_ = trial_;
    flux_ = trial_flux_;
    f_before_ = f_;
    machine_.derivative(x_, i_ * std::conj(axis_), w0_, f_);
    h_before_ = h_;
    history_ = true;
}

} // namespace

void InductionMachine::circuit(CircuitFace& face) const {
    face.norton(*this, std::make_shared<InductionElement>(*this, face));
}

} // namespace gridspace::sim

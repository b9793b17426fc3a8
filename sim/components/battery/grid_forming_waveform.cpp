// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/circuit/space.hpp"
#include "sim/components/battery/battery.hpp"
#include "sim/components/battery/grid_forming.hpp"

#include "common/text.hpp"

#include <cmath>
#include <fmt/format.h>
#include <numbers>

/// A grid-forming converter in the waveform simulation: an averaged three-phase voltage behind a resistance and an
/// inductance, by the same rule as the network. Its control is slow against a step and is extrapolated
/// (Adams-Bashforth).
///
/// The current limit acts as in phasors: the drive e - v across the filter is scaled so that the current it would cause
/// in the steady state is the limit. What current there is beyond the limit all the same (a direct-current offset) a
/// virtual resistance takes down.
namespace gridspace::sim::forming {
namespace {

using emt::PhaseMatrix;
using emt::Rule;
using emt::Space;
using emt::to_phases;
using emt::to_space;

/// Of the terminal voltage that the limit measures.
constexpr double kMeasuringLagS = 1e-4;
/// The virtual resistance takes an excess of current down with this time constant.
constexpr double kExcessS = 2e-4;
constexpr double kRunaway = 5; ///< p.u. of speed

/// What a step changes. p.u.
struct Dynamics {
    State x_{}, f_{}, f_before_{};
    double h_before_{0};
    bool history_{false};
    double k_{0}, g_{0};
    Complex v_, i_, e_; ///< in the standing frame (alpha + j beta)
    double v_zero_{0}, i_zero_{0};
    Complex measured_; ///< terminal voltage in the frame of the internal one
    double share_{1};
    // trial step
    State trial_{};
    double t_{0}, h_{0};
    Complex trial_e_, source_, axis_{1};
    double source_zero_{0};
};

class FormingElement final : public emt::NortonElement, private Dynamics {
  public:
    FormingElement(Battery const& battery, CircuitFace const& face)
        : control_{battery, face.omega()}, w0_{face.omega()}, v_base_{face.peak_v(battery.bus)},
          i_base_{2 * battery.rating_kva * 1e3 / (3 * v_base_)} {}

    [[nodiscard]] PhaseMatrix conductance(double h) const override {
        double const g = i_base_ / v_base_ / (r() + 2 / (h * w0_) * x());
        return PhaseMatrix::sequence(g, g);
    }
    [[nodiscard]] emt::ComplexPhaseMatrix steady_admittance(double speed) const override {
        Complex const y = i_base_ / v_base_ / control_.impedance(speed);
        return emt::ComplexPhaseMatrix::sequence(y, y);
    }
    void use_step(double h) override {
        k_ = 2 / (h * w0_) * x();
        g_ = 1 / (r() + k_);
    }
    void start(Complex volts, Complex amperes, double speed) override;
    void start_unbalanced(std::array<double, 3> const& volts, std::array<double, 3> const& amperes) override;
    [[nodiscard]] Result<void> check_start() const override { return control_.check_start(); }
    void forget_history() override { history_ = false; }
    [[nodiscard]] std::array<double, 3> predict(double t, double h, Rule rule) override;
    [[nodiscard]] int corrections() const override { return 0; }
    [[nodiscard]] std::array<double, 3> correct(double const*) override { return {}; }
    void finish(double const* v) override;
    void save() override { saved_ = static_cast<Dynamics const&>(*this); }
    void restore() override { static_cast<Dynamics&>(*this) = saved_; }
    [[nodiscard]] bool sound() const override { return std::abs(x_[kSpeed]) < kRunaway; } // false for NaN
    [[nodiscard]] Error failure(double t) const override {
        return {ExitCode::usage,
                fmt::format("battery '{}' runs away at {} s: its frequency is {} p.u.", control_.name(), shortest(t),
                            shortest(1 + x_[kSpeed])),
                "look at its droop_percent, its inertia_h_s and what it feeds"};
    }
    [[nodiscard]] double current_a(int phase) const override {
        return to_phases({i_.real(), i_.imag(), i_zero_})[static_cast<std::size_t>(phase)] * i_base_;
    }
    [[nodiscard]] std::optional<Rotor> rotor() const override {
        return Rotor{control_.data.inertia_h_s * control_.rating_kva, hz() * (1 + x_[kSpeed])};
    }
    [[nodiscard]] std::vector<SignalDef> signals() const override { return forming::signals(); }
    [[nodiscard]] double value(std::size_t index) const override { return forming::signal(index, x_, hz(), share_); }
    bool set(std::string_view quantity, double value) override { return control_.change(quantity, value); }
    void set_mode(std::string_view mode) override { control_.mode(mode); }
    void resume(double t, Complex v) override;

  private:
    [[nodiscard]] double r() const { return control_.data.r_pu; }
    [[nodiscard]] double x() const { return control_.data.x_pu; }
    [[nodiscard]] double hz() const { return w0_ / (2 * std::numbers::pi); }
    [[nodiscard]] Complex axis(double t, double angle) const {
        return std::polar(1.0, std::fmod(w0_ * t, 2 * std::numbers::pi) + angle);
    }
    /// Slopes of the accepted state.
    void slopes(double t, State& f) const;
    Control control_;
    double w0_, v_base_, i_base_; ///< bases: peak phase values
    Dynamics saved_;
};

void FormingElement::start(Complex volts, Complex amperes, double speed) {
    v_ = volts / v_base_;
    i_ = amperes / i_base_;
    v_zero_ = i_zero_ = 0;
    x_ = control_.steady_state(v_, i_, speed);
    axis_ = axis(0, x_[kAngle]);
    e_ = x_[kEmf] * axis_;
    measured_ = v_ * std::conj(axis_);
    share_ = 1;
    slopes(0, f_);
    history_ = false;
}

void FormingElement::start_unbalanced(std::array<double, 3> const& volts, std::array<double, 3> const& amperes) {
    emt::Space const v = emt::to_space(volts[0], volts[1], volts[2]),
                     i = emt::to_space(amperes[0], amperes[1], amperes[2]);
    v_ = Complex{v.alpha, v.beta} / v_base_;
    i_ = Complex{i.alpha, i.beta} / i_base_;
    v_zero_ = v.zero / v_base_;
    i_zero_ = i.zero / i_base_;
    slopes(0, f_);
}

void FormingElement::slopes(double t, State& f) const {
    Complex const s = v_ * std::conj(i_);
    control_.derivative(x_, {s.real(), s.imag(), std::abs(v_), (1 - share_) * std::abs(x_[kEmf] - measured_)}, t, f);
}

std::array<double, 3> FormingElement::predict(double t, double h, Rule rule) {
    t_ = t;
    h_ = h;
    double const slope = history_ ? h * h / (2 * h_before_) : 0;
    for (std::size_t s = 0; s < kStates; ++s) {
        trial_[s] = x_[s] + h * f_[s] + slope * (f_[s] - f_before_[s]);
    }
    axis_ = axis(t, trial_[kAngle]);
    // In the frame of the internal voltage.
    Complex const drive = trial_[kEmf] - measured_;
    Complex e = measured_ + control_.share(drive) * drive;
    double const size = std::abs(i_), beyond = size - control_.data.current_limit_pu;
    if (beyond > 0) {
        double const resistance = x() / w0_ / kExcessS;
        e -= resistance * beyond / size * i_ * std::polar(1.0, w0_ * h) * std::conj(axis_);
    }
    trial_e_ = e * axis_;
    if (rule == Rule::trapezoid) {
        source_ = g_ * (trial_e_ + e_ - v_ + (k_ - r()) * i_);
        source_zero_ = g_ * ((k_ - r()) * i_zero_ - v_zero_);
    } else {
        source_ = g_ * (trial_e_ + k_ * i_);
        source_zero_ = g_ * k_ * i_zero_;
    }
    auto const j = to_phases({source_.real(), source_.imag(), source_zero_});
    return {j[0] * i_base_, j[1] * i_base_, j[2] * i_base_};
}

void FormingElement::finish(double const* v) {
    Space const volts = to_space(v[0], v[1], v[2]);
    v_ = Complex{volts.alpha, volts.beta} / v_base_;
    v_zero_ = volts.zero / v_base_;
    i_ = source_ - g_ * v_;
    i_zero_ = source_zero_ - g_ * v_zero_;
    e_ = trial_e_;
    x_ = trial_;
    measured_ += (v_ * std::conj(axis_) - measured_) * (h_ / (kMeasuringLagS + h_));
    share_ = control_.share(x_[kEmf] - measured_);
    f_before_ = f_;
    slopes(t_, f_);
    h_before_ = h_;
    history_ = true;
}

void FormingElement::resume(double t, Complex v) {
    control_.resume(t, v / v_base_, x_);
    axis_ = axis(t, x_[kAngle]);
    e_ = x_[kEmf] * axis_;
    v_ = e_;
    measured_ = x_[kEmf];
    i_ = 0;
    v_zero_ = i_zero_ = 0;
    share_ = 1;
    slopes(t, f_);
    history_ = false;
}

} // namespace

std::shared_ptr<emt::NortonElement> waveform(Battery const& battery, CircuitFace const& face) {
    return std::make_shared<FormingElement>(battery, face);
}

} // namespace gridspace::sim::forming

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/machine/exciter_equations.hpp"
#include "sim/components/machine/machine_checks.hpp"
#include "sim/components/machine/rotor_equations.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

/// A synchronous machine in the phasor simulation.
namespace gridspace::sim {
namespace {

/// A regulator without time constant would be algebraic; this is fast against everything that phasors show.
constexpr double kFastest = 1e-3;

void soften(double& t) {
    t = std::max(t, kFastest);
}

machines::State state_of(std::span<double const> x) {
    machines::State s;
    s.fill(0);
    std::copy(x.begin(), x.end(), s.begin());
    return s;
}

/// Synchronous machine with regulators: the rotor, and a stator without transients (flux follows at once,
/// at nominal speed). States: those of the rotor.
class MachineInjection final : public PhasorInjection {
  public:
    MachineInjection(Machine const& machine, Surroundings const& around);
    [[nodiscard]] std::size_t states() const override { return data_.states; }
    void start(double t, Complex v, Complex s, std::span<double> x) override;
    Complex flow(double t, std::span<double const> x, Complex v, std::span<double> dx) const override;
    [[nodiscard]] std::vector<SignalDef> signals() const override;
    [[nodiscard]] double value(std::size_t signal, double t, std::span<double const> x, Complex v) const override;
    /// The field voltage of a static exciter reaches a limit, or leaves it.
    [[nodiscard]] bool has_event() const override { return data_.avr && !data_.avr->ac8b && !data_.classical; }
    [[nodiscard]] double event(double t, std::span<double const> x) const override;
    void on_event(std::span<double> x) override;
    [[nodiscard]] Result<void> check_start(std::span<double const> x) const override;
    bool set(double t, std::string_view quantity, double value) override;
    void set_mode(std::string_view mode) override { set_.governor = machines::governor_mode(mode); }
    [[nodiscard]] std::optional<Rotor> rotor(std::span<double const> x) const override {
        return Rotor{data_.h * data_.rating_kva, base_hz_ * (1 + x[machines::kSpeed])};
    }

  private:
    struct Stator {
        double id{0}, iq{0};
        Complex i;   ///< out of the machine, own rating
        double v{0}; ///< at the terminals
    };
    [[nodiscard]] Stator stator(machines::State const& x, Complex v) const;

    std::string name_;
    machines::MachineData data_;
    machines::Setpoints set_;
    double w0_, to_network_; ///< own rating over the network's base
    double base_hz_;
    int at_limit_{0};                   ///< -1 lower, 1 upper
    double p_kw_, voltage_setpoint_pu_; ///< as in the network file, or as set since
};

MachineInjection::MachineInjection(Machine const& machine, Surroundings const& around)
    : PhasorInjection{around.bus(machine.bus)}, name_{machine.name.name},
      data_{machines::machine_data(machine, around)}, w0_{around.omega()},
      to_network_{machine.rating_kva / around.base_kva()}, base_hz_{around.frequency_hz()}, p_kw_{machine.p_kw},
      voltage_setpoint_pu_{machine.voltage_setpoint_pu} {
    if (data_.avr) {
        soften(data_.avr->ta_s);
        soften(data_.avr->tr_s);
    }
    if (data_.governor) {
        soften(data_.governor->tg_s);
        soften(data_.governor->tt_s);
    }
}

void MachineInjection::start(double, Complex v, Complex s, std::span<double> x) {
    Complex const i = v == Complex{} ? Complex{} : std::conj(s / to_network_ / v);
    auto const start = machines::steady_state(data_, v, i);
    set_ = start.set;
    std::copy_n(start.x.begin(), x.size(), x.begin());
}

bool MachineInjection::set(double, std::string_view quantity, double value) {
    if (quantity == "p_kw") {
        set_.p_ref += (value - p_kw_) / data_.rating_kva;
        p_kw_ = value;
    } else if (quantity == "voltage_setpoint_pu") {
        set_.v_ref += value - voltage_setpoint_pu_;
        voltage_setpoint_pu_ = value;
    } else if (!data_.governor) {
        return false;
    } else if (quantity == "frequency_setpoint_hz") {
        set_.w_ref = value / base_hz_ - 1;
    } else {
        data_.governor->droop_percent = value;
    }
    return true;
}

MachineInjection::Stator MachineInjection::stator(machines::State const& x, Complex v) const {
    Complex const to_rotor = std::polar(1.0, std::numbers::pi / 2 - x[machines::kAngle]);
    Stator s;
    // Fluxes without the part that currents make of unequal axes; the axes have their own reactances here.
    machines::Flux const flux = machines::subtransient_flux(data_, x, 0, 0);
    if (!connected()) {
        s.v = std::hypot(flux.d, flux.q);
        return s;
    }
    Complex const dq = v * to_rotor;
    // vd + ra id - xq'' iq = -psi_q'',  vq + ra iq + xd'' id = psi_d''
    double const a = -(flux.q + dq.real()), b = flux.d - dq.imag();
    double const det = data_.ra * data_.ra + data_.x2d * data_.x2q;
    s.id = (data_.ra * a + data_.x2q * b) / det;
    s.iq = (data_.ra * b - data_.x2d * a) / det;
    s.i = Complex{s.id, s.iq} / to_rotor;
    s.v = std::abs(v);
    return s;
}

Complex MachineInjection::flow(double, std::span<double const> states, Complex v, std::span<double> dx) const {
    machines::State const x = state_of(states);
    Stator const s = stator(x, v);
    machines::State d;
    machines::derivative(data_, set_, x, s.id, s.iq, s.v, d);
    d[machines::kAngle] = w0_ * x[machines::kSpeed];
    if (has_event()) {
        // Here the limits are events: between them the equations are smooth.
        double const target = machines::field_target(data_, set_, x);
        d[machines::kEfd] = at_limit_ != 0 ? 0 : (target - x[machines::kEfd]) / data_.avr->ta_s;
    }
    std::copy_n(d.begin(), dx.size(), dx.begin());
    return s.i * to_network_;
}

Result<void> MachineInjection::check_start(std::span<double const> x) const {
    if (auto ok = machines::check_gate(name_, data_, x[machines::kGate]); !ok) {
        return ok;
    }
    return machines::check_field(name_, data_, state_of(x));
}

double MachineInjection::event(double, std::span<double const> x) const {
    double const efd = x[machines::kEfd];
    if (at_limit_ == 0) {
        return std::min(data_.avr->efd_max_pu - efd, efd - data_.avr->efd_min_pu);
    }
    return at_limit_ * (machines::field_target(data_, set_, state_of(x)) - efd);
}

void MachineInjection::on_event(std::span<double> x) {
    double& efd = x[machines::kEfd];
    if (at_limit_ != 0) {
        at_limit_ = 0;
        return;
    }
    at_limit_ = data_.avr->efd_max_pu - efd < efd - data_.avr->efd_min_pu ? 1 : -1;
    efd = at_limit_ > 0 ? data_.avr->efd_max_pu : data_.avr->efd_min_pu;
}

std::vector<SignalDef> MachineInjection::signals() const {
    std::string const p = "machine." + name_;
    return {{p + ".frequency_hz", "Hz"}, {p + ".speed_pu", "p.u."}, {p + ".angle_deg", "deg"},
            {p + ".torque_pu", "p.u."},  {p + ".v_pu", "p.u."},     {p + ".efd_pu", "p.u."},
            {p + ".p_kw", "kW"},         {p + ".q_kvar", "kvar"},   {p + ".mechanical_kw", "kW"}};
}

double MachineInjection::value(std::size_t signal, double, std::span<double const> states, Complex v) const {
    machines::State const x = state_of(states);
    Stator const s = stator(x, v);
    Complex const power = (connected() ? v : Complex{}) * std::conj(s.i) * data_.rating_kva;
    switch (signal) {
    case 0:
        return base_hz_ * (1 + x[machines::kSpeed]);
    case 1:
        return 1 + x[machines::kSpeed];
    case 2:
        return x[machines::kAngle] * 180 / std::numbers::pi;
    case 3:
        return machines::torque(data_, x, s.id, s.iq);
    case 4:
        return s.v;
    case 5:
        return machines::field_voltage(data_, x, s.id, s.v);
    case 6:
        return power.real();
    case 7:
        return power.imag();
    default:
        return machines::mechanical_power(data_, x) * data_.rating_kva;
    }
}

} // namespace

std::unique_ptr<PhasorInjection> Machine::phasor(Surroundings const& around) const {
    return std::make_unique<MachineInjection>(*this, around);
}

} // namespace gridspace::sim

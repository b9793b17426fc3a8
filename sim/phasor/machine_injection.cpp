// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/machine_injection.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::sim::phasor {
namespace {

using machines::State;

/// A regulator without time constant would be algebraic; this is fast against everything that phasors show.
constexpr double kFastest = 1e-3;

void soften(double& t) {
    t = std::max(t, kFastest);
}

State state_of(std::span<double const> x) {
    State s;
    std::copy_n(x.begin(), s.size(), s.begin());
    return s;
}

} // namespace

MachineInjection::MachineInjection(Network const& network, Machine const& machine, std::size_t bus)
    : PhasorInjection{bus}, name_{machine.name.name}, data_{machines::machine_data(network, machine)},
      w0_{2 * std::numbers::pi * network.frequency_hz}, to_network_{machine.rating_kva / network.power_kva},
      base_hz_{network.frequency_hz}, p_kw_{machine.p_kw}, voltage_setpoint_pu_{machine.voltage_setpoint_pu} {
    if (data_.avr) {
        soften(data_.avr->ta_s);
        soften(data_.avr->tr_s);
    }
    if (data_.governor) {
        soften(data_.governor->tg_s);
        soften(data_.governor->tt_s);
    }
}

void MachineInjection::start(double, Complex v, std::span<double> x) {
    Complex const i = v == Complex{} ? Complex{} : std::conj(start_power_ / to_network_ / v);
    auto const start = machines::steady_state(data_, v, i);
    set_ = start.set;
    std::copy(start.x.begin(), start.x.end(), x.begin());
}

bool MachineInjection::set(std::string_view quantity, double value) {
    if (quantity == "p_kw") {
        set_.p_ref += (value - p_kw_) / data_.rating_kva;
        p_kw_ = value;
    } else if (quantity == "voltage_setpoint_pu") {
        set_.v_ref += value - voltage_setpoint_pu_;
        voltage_setpoint_pu_ = value;
    } else if (data_.governor) {
        data_.governor->droop_percent = value;
    }
    return quantity != "droop_percent" || data_.governor;
}

MachineInjection::Stator MachineInjection::stator(State const& x, Complex v) const {
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
    State const x = state_of(states);
    Stator const s = stator(x, v);
    State d;
    machines::derivative(data_, set_, x, s.id, s.iq, s.v, d);
    d[machines::kAngle] = w0_ * x[machines::kSpeed];
    if (has_event()) {
        // Here the limits are events: between them the equations are smooth.
        double const target = data_.avr->ka * (set_.v_ref - x[machines::kVmeas]);
        d[machines::kEfd] = at_limit_ != 0 ? 0 : (target - x[machines::kEfd]) / data_.avr->ta_s;
    }
    std::copy(d.begin(), d.end(), dx.begin());
    return s.i * to_network_;
}

Result<void> MachineInjection::check_field(std::span<double const> x) const {
    double const efd = x[machines::kEfd];
    if (has_event() && (efd > data_.avr->efd_max_pu || efd < data_.avr->efd_min_pu)) {
        return fail(
            ExitCode::usage,
            fmt::format("machine '{}' needs a field voltage of {:.3f} p.u. at the start, outside its limits {} to {}",
                        name_, efd, shortest(data_.avr->efd_min_pu), shortest(data_.avr->efd_max_pu)),
            "ask it for less reactive power (voltage_setpoint_pu), or widen efd_min_pu and efd_max_pu");
    }
    return {};
}

double MachineInjection::event(double, std::span<double const> x) const {
    double const efd = x[machines::kEfd];
    if (at_limit_ == 0) {
        return std::min(data_.avr->efd_max_pu - efd, efd - data_.avr->efd_min_pu);
    }
    return at_limit_ * (data_.avr->ka * (set_.v_ref - x[machines::kVmeas]) - efd);
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
    State const x = state_of(states);
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
        return x[machines::kEfd];
    case 6:
        return power.real();
    case 7:
        return power.imag();
    default:
        return (data_.governor ? x[machines::kPower] : x[machines::kGate]) * data_.rating_kva;
    }
}

} // namespace gridspace::sim::phasor

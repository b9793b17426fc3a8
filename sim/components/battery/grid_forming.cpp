// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/battery/grid_forming.hpp"

#include "sim/components/battery/battery.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::sim {

void GridForming::fields(elements::Fields& f) {
    using namespace elements;
    f.number("voltage_setpoint_pu", voltage_setpoint_pu, positive("voltage at its bus at the start"));
    f.number("droop_percent", droop_percent, positive("frequency drop at rated active power"));
    f.number("voltage_droop_percent", voltage_droop_percent, not_negative("voltage drop at rated reactive power"));
    f.number("inertia_h_s", inertia_h_s, positive("virtual inertia constant"));
    f.number("integral_ki", integral_ki, not_negative("integral gain of the frequency; 0: droop only"));
    f.number("voltage_ki", voltage_ki, positive("integral gain of the voltage, 1/s"));
    f.number("power_filter_s", power_filter_s, positive("time constant of the measured reactive power"));
    f.number("r_pu", r_pu, not_negative("resistance of its filter and virtual impedance"));
    f.number("x_pu", x_pu, positive("reactance of its filter and virtual impedance"));
    f.number("current_limit_pu", current_limit_pu, positive("of its rated current"));
    f.number("ramp_s", ramp_s, positive("of its voltage from nothing to all, after it stood by"));
}

namespace forming {

Control::Control(Battery const& battery, double w0)
    : data{battery.forming}, rating_kva{battery.rating_kva}, name_{battery.name.name}, w0_{w0}, p_kw_{battery.p_kw},
      capacity_kwh_{battery.capacity_kwh}, efficiency_{battery.efficiency},
      soc_start_percent_{battery.soc_start_percent} {
    set.isochronous = data.integral_ki > 0;
}

State Control::steady_state(Complex v, Complex i, double speed) {
    Complex const e = v + impedance(speed) * i;
    Complex const s = v * std::conj(i);
    set.p_ref = s.real();
    set.q_ref = s.imag();
    set.v_ref = std::abs(v);
    start_current_ = std::abs(i);
    return {0, std::arg(e), std::abs(e), s.imag(), 0, soc_start_percent_};
}

Result<void> Control::check_start() const {
    if (start_current_ <= data.current_limit_pu) {
        return {};
    }
    return fail(ExitCode::usage,
                fmt::format("battery '{}' would have to give {:.4g} of its rated current at the start, more than its "
                            "current_limit_pu of {:.4g}",
                            name_, start_current_, data.current_limit_pu),
                "give it a larger rating_kva, another voltage_setpoint_pu, or less load");
}

void Control::derivative(State const& x, Terminals const& at, double t, State& dx) const {
    double const off = x[kSpeed] - set.w_ref;
    double const rise = std::clamp((t - set.ramp_start_s) / data.ramp_s, 0.0, 1.0);
    double const v_ref = set.ramp_from + (set.v_ref - set.ramp_from) * rise;
    double const droop = data.voltage_droop_percent / 100 * (x[kReactive] - set.q_ref);
    dx[kSpeed] = (set.p_ref + x[kIntegral] - at.p - off * 100 / data.droop_percent) / (2 * data.inertia_h_s);
    dx[kAngle] = w0_ * x[kSpeed];
    dx[kEmf] = data.voltage_ki * (v_ref - droop - at.v - at.withheld);
    dx[kReactive] = (at.q - x[kReactive]) / data.power_filter_s;
    dx[kIntegral] = set.isochronous ? -data.integral_ki * off : 0;
    double const kw = at.p * rating_kva;
    dx[kSoc] = -100 * (kw > 0 ? kw / efficiency_ : kw * efficiency_) / (capacity_kwh_ * 3600);
}

double Control::share(Complex drive) const {
    double const most = data.current_limit_pu * std::abs(impedance()), size = std::abs(drive);
    return size > most ? most / size : 1;
}

void Control::resume(double t, Complex v, State& x) {
    constexpr double kDead = 0.05;  // p.u.: no angle to begin with
    constexpr double kFirst = 0.01; // p.u.: on a dead bus
    double const size = std::abs(v);
    x[kSpeed] = x[kIntegral] = x[kReactive] = 0;
    x[kAngle] = size > kDead ? std::arg(v) : 0;
    x[kEmf] = size > kDead ? size : kFirst;
    set.q_ref = 0;
    set.ramp_from = x[kEmf];
    set.ramp_start_s = t;
}

bool Control::change(std::string_view quantity, double value) {
    if (quantity == "p_kw") {
        set.p_ref += (value - p_kw_) / rating_kva;
        p_kw_ = value;
    } else if (quantity == "voltage_setpoint_pu") {
        set.v_ref += value - data.voltage_setpoint_pu;
        data.voltage_setpoint_pu = value;
    } else if (quantity == "frequency_setpoint_hz") {
        set.w_ref = value * 2 * std::numbers::pi / w0_ - 1;
    } else if (quantity == "droop_percent") {
        data.droop_percent = value;
    } else {
        return false;
    }
    return true;
}

std::vector<SignalDef> signals() {
    return {{"frequency_hz", "Hz"},
            {"angle_deg", "deg"},
            {"emf_pu", "p.u."},
            {"soc_percent", "%"},
            {"limited_share", "p.u."}};
}

double signal(std::size_t index, State const& x, double base_hz, double share) {
    switch (index) {
    case 0:
        return base_hz * (1 + x[kSpeed]);
    case 1:
        return x[kAngle] * 180 / std::numbers::pi;
    case 2:
        return x[kEmf];
    case 3:
        return x[kSoc];
    default:
        return 1 - share;
    }
}

} // namespace forming
} // namespace gridspace::sim

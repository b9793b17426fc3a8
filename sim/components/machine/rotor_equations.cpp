// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/machine/rotor_equations.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gridspace::sim::machines {
namespace {

/// Motion of a first-order lag towards `target`; a state without time constant is set by limit() instead.
double lag(double target, double x, double t) {
    return t > 0 ? (target - x) / t : 0;
}

double turbine_target(MachineData const& d, Setpoints const& set, State const& x) {
    double const fast = set.governor == GovernorMode::fixed_power ? 0 : x[kSpeed] - set.w_ref;
    return set.p_ref - fast / (d.governor->droop_percent / 100) - x[kIntegral];
}

double field_target(MachineData const& d, Setpoints const& set, State const& x) {
    return d.avr->ka * (set.v_ref - x[kVmeas]);
}

} // namespace

GovernorMode governor_mode(std::string_view word) {
    return word == "droop"         ? GovernorMode::droop
           : word == "fixed_power" ? GovernorMode::fixed_power
                                   : GovernorMode::isochronous;
}

Flux subtransient_flux(MachineData const& d, State const& x, double id, double iq) {
    if (d.classical) {
        return {x[kEq1], 0};
    }
    Flux flux{d.gamma_d * x[kEq1] + (1 - d.gamma_d) * x[kPsi1d], d.gamma_q * x[kPsi2q]};
    if (!d.round_subtransient()) {
        flux.d += (d.x2() - d.x2d) * id;
        flux.q += (d.x2() - d.x2q) * iq;
    }
    return flux;
}

double torque(MachineData const& d, State const& x, double id, double iq) {
    Flux const flux = subtransient_flux(d, x, id, iq);
    return flux.d * iq - flux.q * id; // the common reactance adds nothing
}

void derivative(MachineData const& d, Setpoints const& set, State const& x, double id, double iq, double v, State& dx) {
    if (d.classical) {
        dx[kEq1] = dx[kPsi1d] = dx[kPsi2q] = dx[kEfd] = dx[kVmeas] = 0;
    } else {
        double const damper = x[kPsi1d] + (d.xd1 - d.xl) * id - x[kEq1];
        dx[kEq1] = (x[kEfd] - x[kEq1] - (d.xd - d.xd1) * (id - d.coupling * damper)) / d.td01;
        dx[kPsi1d] = -damper / d.td02;
        dx[kPsi2q] = -(x[kPsi2q] + (d.xq - d.xl) * iq) / d.tq02;
        dx[kEfd] = dx[kVmeas] = 0;
        if (d.avr) {
            dx[kVmeas] = lag(v, x[kVmeas], d.avr->tr_s);
            dx[kEfd] = lag(field_target(d, set, x), x[kEfd], d.avr->ta_s);
            if ((x[kEfd] >= d.avr->efd_max_pu && dx[kEfd] > 0) || (x[kEfd] <= d.avr->efd_min_pu && dx[kEfd] < 0)) {
                dx[kEfd] = 0;
            }
        }
    }
    dx[kGate] = dx[kPower] = dx[kIntegral] = 0;
    double mechanical = set.p_ref;
    if (d.governor) {
        dx[kGate] = lag(turbine_target(d, set, x), x[kGate], d.governor->tg_s);
        dx[kPower] = lag(x[kGate], x[kPower], d.governor->tt_s);
        if (set.governor == GovernorMode::isochronous) {
            dx[kIntegral] = d.governor->integral_ki * (x[kSpeed] - set.w_ref);
        }
        mechanical = x[kPower];
    }
    double const mechanical_torque = d.classical ? mechanical : mechanical / (1 + x[kSpeed]);
    dx[kSpeed] = (mechanical_torque - torque(d, x, id, iq) - d.damping * x[kSpeed]) / (2 * d.h);
    dx[kAngle] = 0; // times the base frequency, which the engine knows: it adds w0 * speed
}

void limit(MachineData const& d, Setpoints const& set, double v, State& x) {
    if (d.avr && !d.classical) {
        if (d.avr->tr_s == 0) {
            x[kVmeas] = v;
        }
        if (d.avr->ta_s == 0) {
            x[kEfd] = field_target(d, set, x);
        }
        x[kEfd] = std::clamp(x[kEfd], d.avr->efd_min_pu, d.avr->efd_max_pu);
    }
    if (d.governor) {
        if (d.governor->tg_s == 0) {
            x[kGate] = turbine_target(d, set, x);
        }
        if (d.governor->tt_s == 0) {
            x[kPower] = x[kGate];
        }
    }
}

Start steady_state(MachineData const& d, std::complex<double> v, std::complex<double> i, double electrical_speed) {
    using namespace std::complex_literals;
    Start start;
    State& x = start.x;
    x = {};
    // Seen from the d-axis only the field is left of (stator flux + xq i): it points along d.
    std::complex<double> const flux = (v + d.ra * i) / (1i * electrical_speed);
    std::complex<double> const along_d = flux + d.xq * i;
    double const d_axis = std::arg(along_d);
    std::complex<double> const dq = i * std::polar(1.0, -d_axis);
    double const id = dq.real(), iq = dq.imag();
    x[kAngle] = d_axis + std::numbers::pi / 2;
    if (d.classical) {
        x[kEq1] = std::abs(along_d);
        x[kEfd] = x[kEq1];
    } else {
        x[kEfd] = std::abs(along_d) + (d.xd - d.xq) * id;
        x[kEq1] = x[kEfd] - (d.xd - d.xd1) * id;
        x[kPsi1d] = x[kEq1] - (d.xd1 - d.xl) * id;
        x[kPsi2q] = -(d.xq - d.xl) * iq;
    }
    x[kVmeas] = std::abs(v);
    start.set.efd = x[kEfd];
    start.set.v_ref = x[kVmeas] + (d.avr ? x[kEfd] / d.avr->ka : 0);
    start.set.p_ref = torque(d, x, id, iq);
    x[kGate] = x[kPower] = start.set.p_ref;
    return start;
}

} // namespace gridspace::sim::machines

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/machine/rotor_equations.hpp"

#include "sim/components/machine/exciter_equations.hpp"
#include "sim/components/machine/governor_equations.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace gridspace::sim::machines {
namespace {

/// In p.u. of the field voltage that it needs. Saturation is that of the field's own flux, as in GENSAL of PSS/E.
double field_current(MachineData const& d, State const& x, double id) {
    double const damper = x[kPsi1d] + (d.xd1 - d.xl) * id - x[kEq1];
    return x[kEq1] + (d.xd - d.xd1) * (id - d.coupling * damper) + d.saturation.drop(x[kEq1]);
}

/// The field current, where the exciter goes by it.
double seen_field_current(MachineData const& d, State const& x, double id) {
    return d.avr->ac8b || d.avr->ceiling ? field_current(d, x, id) : 0;
}

/// At the terminals and nominal speed.
double electric_power(MachineData const& d, double air_gap, double id, double iq) {
    return air_gap - d.ra * (id * id + iq * iq);
}

} // namespace

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

double field_voltage(MachineData const& d, State const& x, double id, double v) {
    return d.avr ? exciter_output(d, x, seen_field_current(d, x, id), v) : x[kEfd];
}

double mechanical_power(MachineData const& d, State const& x) {
    return d.governor ? governed_power(d, x) : x[kGate];
}

double torque(MachineData const& d, State const& x, double id, double iq) {
    Flux const flux = subtransient_flux(d, x, id, iq);
    return flux.d * iq - flux.q * id; // the common reactance adds nothing
}

void derivative(MachineData const& d, Setpoints const& set, State const& x, double id, double iq, double v, State& dx) {
    std::fill(dx.begin() + kExhaust, dx.begin() + static_cast<std::ptrdiff_t>(d.states), 0.0);
    if (d.classical) {
        dx[kEq1] = dx[kPsi1d] = dx[kPsi2q] = dx[kEfd] = dx[kVmeas] = 0;
    } else {
        double const damper = x[kPsi1d] + (d.xd1 - d.xl) * id - x[kEq1];
        double const current = d.avr ? seen_field_current(d, x, id) : 0;
        double const efd = d.avr ? exciter_output(d, x, current, v) : x[kEfd];
        dx[kEq1] = (efd - x[kEq1] - (d.xd - d.xd1) * (id - d.coupling * damper) - d.saturation.drop(x[kEq1])) / d.td01;
        dx[kPsi1d] = -damper / d.td02;
        dx[kPsi2q] = -(x[kPsi2q] + (d.xq - d.xl) * iq) / d.tq02;
        dx[kEfd] = dx[kVmeas] = 0;
        if (d.avr) {
            exciter_derivative(d, set, x, current, v, dx);
        }
    }
    dx[kGate] = dx[kPower] = dx[kIntegral] = 0;
    double const air_gap = torque(d, x, id, iq);
    double mechanical = set.p_ref;
    if (d.governor) {
        governor_derivative(d, set, x, electric_power(d, air_gap, id, iq), dx);
        mechanical = mechanical_power(d, x);
    }
    double const mechanical_torque = d.classical ? mechanical : mechanical / (1 + x[kSpeed]);
    dx[kSpeed] = (mechanical_torque - air_gap - d.damping * x[kSpeed]) / (2 * d.h);
    dx[kAngle] = 0; // times the base frequency, which the engine knows: it adds w0 * speed
}

void limit(MachineData const& d, Setpoints const& set, double v, State& x) {
    if (d.avr && !d.classical) {
        limit_exciter(d, set, v, x);
    }
    if (d.governor) {
        limit_governor(d, set, x);
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
        x[kEfd] += d.saturation.drop(x[kEq1]);
        x[kPsi1d] = x[kEq1] - (d.xd1 - d.xl) * id;
        x[kPsi2q] = -(d.xq - d.xl) * iq;
    }
    x[kVmeas] = std::abs(v);
    start.set.efd = x[kEfd];
    start.set.v_ref = x[kVmeas];
    if (d.avr) {
        start_exciter(d, x[kEfd], start.set, x);
    }
    double const power = torque(d, x, id, iq);
    start.set.p_ref = power;
    x[kGate] = x[kPower] = power;
    if (d.governor) {
        start_governor(d, power, electric_power(d, power, id, iq), start.set, x);
    }
    return start;
}

} // namespace gridspace::sim::machines

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/machine/rotor_equations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace gridspace::sim::machines {
namespace {

/// Motion of a first-order lag towards `target`; a state without time constant is set by limit() instead.
double lag(double target, double x, double t) {
    return t > 0 ? (target - x) / t : 0;
}

double wanted_power(MachineData const& d, Setpoints const& set, State const& x) {
    double const fast = set.governor == GovernorMode::fixed_power ? 0 : x[kSpeed] - set.w_ref;
    return set.p_ref - fast / (d.governor->droop_percent / 100) - x[kIntegral];
}

/// The most that the load limit lets through.
double permitted_power(MachineData const& d, State const& x) {
    auto const& limit = d.governor->load_limit;
    return limit ? limit->power_pu + limit->gain * (limit->power_pu - x[kExhaust])
                 : std::numeric_limits<double>::infinity();
}

double gate(Governor const& g, State const& x) {
    return std::clamp(x[kGate], g.lowest(), g.highest());
}

void governor_derivative(MachineData const& d, Setpoints const& set, State const& x, State& dx) {
    Governor const& g = *d.governor;
    double const wanted = wanted_power(d, set, x), permitted = permitted_power(d, x);
    dx[kGate] = lag(std::min(wanted, permitted), x[kGate], g.tg_s);
    if ((x[kGate] >= g.highest() && dx[kGate] > 0) || (x[kGate] <= g.lowest() && dx[kGate] < 0)) {
        dx[kGate] = 0;
    }
    dx[kPower] = lag(gate(g, x), x[kPower], g.tt_s);
    if (g.load_limit) {
        dx[kExhaust] = lag(x[kPower], x[kExhaust], g.load_limit->t_s);
    }
    if (set.governor == GovernorMode::isochronous) {
        double const by = x[kSpeed] - set.w_ref;
        bool const winds_up = (by < 0 && wanted > std::min(permitted, g.highest())) || (by > 0 && wanted < g.lowest());
        dx[kIntegral] = winds_up ? 0 : g.integral_ki * by;
    }
}

/// Output of (1 + lead s) / (1 + lag s) whose lag is at `x`; without one its input.
double lead_lag(double input, double x, double lead, double lag) {
    return lag > 0 ? x + lead / lag * (input - x) : input;
}

/// IEEE 421.5, figure of PSS1A: gain, washout, two lead-lags.
struct StabilizerOutputs {
    double washed, first, second;
};
StabilizerOutputs stabilizer_outputs(Stabilizer const& s, State const& x) {
    double const washed = s.gain * x[kSpeed] - x[kWashout];
    double const first = lead_lag(washed, x[kFirst], s.t1_s, s.t2_s);
    return {washed, first, lead_lag(first, x[kSecond], s.t3_s, s.t4_s)};
}

/// What the regulator corrects.
double regulator_error(Avr const& r, Setpoints const& set, State const& x) {
    double out = set.v_ref - x[kVmeas];
    if (r.stabilizer) {
        out += std::clamp(stabilizer_outputs(*r.stabilizer, x).second, r.stabilizer->min_pu, r.stabilizer->max_pu);
    }
    if (r.kf > 0) {
        out -= r.kf / r.tf_s * x[kEfd] - x[kRate];
    }
    return out;
}

void regulator_derivative(MachineData const& d, Setpoints const& set, State const& x, double v, State& dx) {
    Avr const& r = *d.avr;
    dx[kVmeas] = lag(v, x[kVmeas], r.tr_s);
    dx[kEfd] = lag(field_target(d, set, x), x[kEfd], r.ta_s);
    if ((x[kEfd] >= r.efd_max_pu && dx[kEfd] > 0) || (x[kEfd] <= r.efd_min_pu && dx[kEfd] < 0)) {
        dx[kEfd] = 0;
    }
    if (r.tb_s > 0) {
        dx[kLead] = lag(regulator_error(r, set, x), x[kLead], r.tb_s);
    }
    if (r.kf > 0) {
        dx[kRate] = lag(r.kf / r.tf_s * x[kEfd], x[kRate], r.tf_s);
    }
    if (r.stabilizer) {
        Stabilizer const& s = *r.stabilizer;
        auto const outputs = stabilizer_outputs(s, x);
        dx[kWashout] = lag(s.gain * x[kSpeed], x[kWashout], s.washout_s);
        dx[kFirst] = lag(outputs.washed, x[kFirst], s.t2_s);
        dx[kSecond] = lag(outputs.first, x[kSecond], s.t4_s);
    }
}

double field_current(MachineData const& d, State const& x, double id) {
    double const damper = x[kPsi1d] + (d.xd1 - d.xl) * id - x[kEq1];
    return x[kEq1] + (d.xd - d.xd1) * (id - d.coupling * damper);
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

std::size_t moving_states(MachineData const& d) {
    bool const of_exciter = !d.classical && d.avr && (d.avr->tb_s > 0 || d.avr->kf > 0 || d.avr->stabilizer);
    return of_exciter                             ? std::size_t{kStates}
           : d.governor && d.governor->load_limit ? std::size_t{kExhaust} + 1
                                                  : std::size_t{kExhaust};
}

double field_target(MachineData const& d, Setpoints const& set, State const& x) {
    return d.avr->ka * lead_lag(regulator_error(*d.avr, set, x), x[kLead], d.avr->tc_s, d.avr->tb_s);
}

double field_voltage(MachineData const& d, State const& x, double id, double v) {
    if (!d.avr || !d.avr->ceiling) {
        return x[kEfd];
    }
    FieldCeiling const& c = *d.avr->ceiling;
    double const lowest = v * c.min_pu;
    return std::clamp(x[kEfd], lowest, std::max(lowest, v * c.max_pu - c.kc_pu * field_current(d, x, id)));
}

double mechanical_power(MachineData const& d, State const& x) {
    if (!d.governor) {
        return x[kGate];
    }
    Governor const& g = *d.governor;
    double const at_once = g.lead_s > 0 ? g.lead_s / g.tt_s * (gate(g, x) - x[kPower]) : 0;
    return x[kPower] + at_once - g.damping_pu * x[kSpeed];
}

double torque(MachineData const& d, State const& x, double id, double iq) {
    Flux const flux = subtransient_flux(d, x, id, iq);
    return flux.d * iq - flux.q * id; // the common reactance adds nothing
}

void derivative(MachineData const& d, Setpoints const& set, State const& x, double id, double iq, double v, State& dx) {
    std::fill(dx.begin() + kExhaust, dx.end(), 0.0);
    if (d.classical) {
        dx[kEq1] = dx[kPsi1d] = dx[kPsi2q] = dx[kEfd] = dx[kVmeas] = 0;
    } else {
        double const damper = x[kPsi1d] + (d.xd1 - d.xl) * id - x[kEq1];
        dx[kEq1] = (field_voltage(d, x, id, v) - x[kEq1] - (d.xd - d.xd1) * (id - d.coupling * damper)) / d.td01;
        dx[kPsi1d] = -damper / d.td02;
        dx[kPsi2q] = -(x[kPsi2q] + (d.xq - d.xl) * iq) / d.tq02;
        dx[kEfd] = dx[kVmeas] = 0;
        if (d.avr) {
            regulator_derivative(d, set, x, v, dx);
        }
    }
    dx[kGate] = dx[kPower] = dx[kIntegral] = 0;
    double mechanical = set.p_ref;
    if (d.governor) {
        governor_derivative(d, set, x, dx);
        mechanical = mechanical_power(d, x);
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
            x[kGate] = std::min(wanted_power(d, set, x), permitted_power(d, x));
        }
        x[kGate] = gate(*d.governor, x);
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
    if (d.avr && d.avr->tb_s > 0) {
        x[kLead] = x[kEfd] / d.avr->ka;
    }
    if (d.avr && d.avr->kf > 0) {
        x[kRate] = d.avr->kf / d.avr->tf_s * x[kEfd];
    }
    start.set.p_ref = torque(d, x, id, iq);
    x[kGate] = x[kPower] = start.set.p_ref;
    x[kExhaust] = d.governor && d.governor->load_limit ? x[kPower] : 0;
    return start;
}

} // namespace gridspace::sim::machines

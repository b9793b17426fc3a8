// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/machine/degov.hpp"

#include "sim/components/machine/blocks.hpp"

namespace gridspace::sim::machines {
namespace {

/// What the control box is to bring to zero.
double degov_error(Governor const& g, Setpoints const& set, State const& x, double electric_power) {
    Degov const& e = *g.degov;
    double out = 0;
    if (set.governor != GovernorMode::fixed_power) {
        out -= x[kSpeed] - set.w_ref;
    }
    if (set.governor != GovernorMode::isochronous) {
        double const power = e.droop_control == DroopControl::throttle ? x[kGate]
                             : e.te_s > 0                              ? x[kPower]
                                                                       : electric_power;
        out += g.droop_percent / 100 * (set.p_ref - power);
    }
    return out;
}

} // namespace

double degov_power(Degov const& e, State const& x) {
    double const torque = e.td_s > 0 ? DeadTime::output(&x[kDeadTime]) : x[kGate];
    return torque * (1 + x[kSpeed]);
}

void degov_derivative(Governor const& g, Setpoints const& set, State const& x, double electric_power, State& dx) {
    Degov const& e = *g.degov;
    double out = degov_error(g, set, x, electric_power);
    if (e.t1_s > 0) { // t1 t2 y'' + t1 y' + y = u
        dx[kBox] = x[kBoxRate];
        dx[kBoxRate] = ((out - x[kBox]) / e.t1_s - x[kBoxRate]) / e.t2_s;
        out = x[kBox] + e.t3_s * x[kBoxRate];
    }
    dx[kActuator] = lag(out, x[kActuator], e.t5_s);
    out = lead_lag(out, x[kActuator], e.t4_s, e.t5_s);
    dx[kActuator2] = lag(out, x[kActuator2], e.t6_s);
    out = lead_lag(out, x[kActuator2], 0, e.t6_s);
    // The integral last: it is the position of the throttle, which has stops.
    dx[kGate] = held(e.k * out, x[kGate], g.lowest(), g.highest());
    dx[kPower] = lag(electric_power, x[kPower], e.te_s);
    if (e.td_s > 0) {
        DeadTime::derivative(&x[kDeadTime], x[kGate], e.td_s, &dx[kDeadTime]);
    }
}

void start_degov(Governor const& g, double power, double electric_power, Setpoints& set, State& x) {
    Degov const& e = *g.degov;
    x[kPower] = e.te_s > 0 ? electric_power : 0;
    x[kDeadTime] = e.td_s > 0 ? power : 0;
    set.p_ref = e.droop_control == DroopControl::throttle ? power : electric_power;
    set.governor = g.droop_percent > 0 ? GovernorMode::droop : GovernorMode::isochronous;
}

} // namespace gridspace::sim::machines

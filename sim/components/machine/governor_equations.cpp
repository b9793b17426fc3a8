// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/machine/governor_equations.hpp"

#include "sim/components/machine/blocks.hpp"
#include "sim/components/machine/degov.hpp"

#include <algorithm>
#include <limits>

namespace gridspace::sim::machines {
namespace {

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

/// TGOV1 with an integral, and GAST.
void turbine_derivative(MachineData const& d, Setpoints const& set, State const& x, State& dx) {
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

} // namespace

GovernorMode governor_mode(std::string_view word) {
    return word == "droop"         ? GovernorMode::droop
           : word == "fixed_power" ? GovernorMode::fixed_power
                                   : GovernorMode::isochronous;
}

double governed_power(MachineData const& d, State const& x) {
    Governor const& g = *d.governor;
    if (g.degov) {
        return degov_power(*g.degov, x);
    }
    double const at_once = g.lead_s > 0 ? g.lead_s / g.tt_s * (gate(g, x) - x[kPower]) : 0;
    return x[kPower] + at_once - g.damping_pu * x[kSpeed];
}

void governor_derivative(MachineData const& d, Setpoints const& set, State const& x, double electric_power, State& dx) {
    if (d.governor->degov) {
        degov_derivative(*d.governor, set, x, electric_power, dx);
    } else {
        turbine_derivative(d, set, x, dx);
    }
}

void limit_governor(MachineData const& d, Setpoints const& set, State& x) {
    Governor const& g = *d.governor;
    if (!g.degov && g.tg_s == 0) {
        x[kGate] = std::min(wanted_power(d, set, x), permitted_power(d, x));
    }
    x[kGate] = gate(g, x);
    if (!g.degov && g.tt_s == 0) {
        x[kPower] = x[kGate];
    }
}

void start_governor(MachineData const& d, double power, double electric_power, Setpoints& set, State& x) {
    x[kGate] = power;
    if (d.governor->degov) {
        start_degov(*d.governor, power, electric_power, set, x);
        return;
    }
    x[kPower] = power;
    x[kExhaust] = d.governor->load_limit ? power : 0;
}

} // namespace gridspace::sim::machines

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/machine/ac8b.hpp"

#include "sim/components/machine/blocks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace gridspace::sim::machines {
namespace {

/// Output of the control before its limits.
double pid(Ac8b const& a, double error, State const& x) {
    double const derivative = a.kdr > 0 ? a.kdr / a.tdr_s * (error - x[kPidLag]) : 0;
    return a.kpr * error + x[kPidIntegral] + derivative;
}

/// VFE without its part of the field current: what the alternator's own field needs for its voltage `ve`.
double excitation(MachineData const& d, double ve) {
    return d.avr->ac8b->ke * ve + d.exciter.drop(ve);
}

/// The voltage at which the alternator's field is at its limit VFEMAX: KE VE + VE SE(VE) = VFEMAX - KD IFD.
double highest_voltage(MachineData const& d, double field_current) {
    Ac8b const& a = *d.avr->ac8b;
    if (!a.vfe_max_pu) {
        return std::numeric_limits<double>::infinity();
    }
    double const left = *a.vfe_max_pu - a.kd * field_current, beyond = left - a.ke * d.exciter.a;
    if (d.exciter.b == 0 || beyond <= 0) {
        return std::max(left / a.ke, a.ve_min_pu);
    }
    double const b = d.exciter.b;
    return std::max(d.exciter.a + (std::sqrt(a.ke * a.ke + 4 * b * beyond) - a.ke) / (2 * b), a.ve_min_pu);
}

} // namespace

double rectified(double ve, double drop) {
    // The standard rounds to 0.577, 0.433 and 1.732; so the modes meet.
    constexpr double kRoot3 = std::numbers::sqrt3;
    if (drop <= 0) {
        return std::max(ve, 0.0);
    }
    if (drop <= kRoot3 / 4 * ve) {
        return ve - drop / kRoot3;
    }
    if (drop < 0.75 * ve) {
        return std::sqrt(0.75 * ve * ve - drop * drop);
    }
    return std::max(kRoot3 * (ve - drop), 0.0);
}

void ac8b_derivative(MachineData const& d, double error, double field_current, State const& x, State& dx) {
    Ac8b const& a = *d.avr->ac8b;
    double const wanted = pid(a, error, x);
    bool const winds_up = (error > 0 && wanted > a.highest()) || (error < 0 && wanted < a.lowest());
    dx[kPidIntegral] = winds_up ? 0 : a.kir * error;
    dx[kPidLag] = lag(error, x[kPidLag], a.tdr_s);
    double const amplified = d.avr->ka * std::clamp(wanted, a.lowest(), a.highest());
    dx[kRegulator] = held(lag(amplified, x[kRegulator], d.avr->ta_s), x[kRegulator], a.vr_min_pu, a.vr_max_pu);
    double const left = x[kRegulator] - excitation(d, x[kEfd]) - a.kd * field_current;
    dx[kEfd] = held(left / a.te_s, x[kEfd], a.ve_min_pu, highest_voltage(d, field_current));
}

double ac8b_regulator(MachineData const& d, double error, State const& x) {
    Ac8b const& a = *d.avr->ac8b;
    return std::clamp(d.avr->ka * std::clamp(pid(a, error, x), a.lowest(), a.highest()), a.vr_min_pu, a.vr_max_pu);
}

double start_ac8b(MachineData const& d, double efd, State& x) {
    Ac8b const& a = *d.avr->ac8b;
    // In a steady state the field current is the field voltage. One of the three modes gives it.
    constexpr double kRoot3 = std::numbers::sqrt3;
    double const drop = std::max(a.kc * efd, 0.0);
    double ve = efd + drop / kRoot3;
    if (drop > kRoot3 / 4 * ve) {
        ve = std::sqrt((efd * efd + drop * drop) / 0.75);
    }
    if (drop > 0.75 * ve) {
        ve = efd / kRoot3 + drop;
    }
    x[kEfd] = ve;
    x[kRegulator] = excitation(d, ve) + a.kd * efd;
    double const output = x[kRegulator] / d.avr->ka;
    if (a.kir > 0) {
        x[kPidIntegral] = output;
        return 0;
    }
    double const error = output / a.kpr;
    x[kPidLag] = error;
    return error;
}

} // namespace gridspace::sim::machines

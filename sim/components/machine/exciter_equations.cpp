// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/machine/exciter_equations.hpp"

#include "sim/components/machine/ac8b.hpp"
#include "sim/components/machine/blocks.hpp"

#include <algorithm>

namespace gridspace::sim::machines {
namespace {

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

void static_exciter_derivative(MachineData const& d, Setpoints const& set, State const& x, State& dx) {
    Avr const& r = *d.avr;
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
}

} // namespace

double field_target(MachineData const& d, Setpoints const& set, State const& x) {
    return d.avr->ka * lead_lag(regulator_error(*d.avr, set, x), x[kLead], d.avr->tc_s, d.avr->tb_s);
}

double exciter_output(MachineData const& d, State const& x, double field_current, double v) {
    if (d.avr->ac8b) {
        return rectified(x[kEfd], d.avr->ac8b->kc * field_current);
    }
    if (!d.avr->ceiling) {
        return x[kEfd];
    }
    FieldCeiling const& c = *d.avr->ceiling;
    double const lowest = v * c.min_pu;
    return std::clamp(x[kEfd], lowest, std::max(lowest, v * c.max_pu - c.kc_pu * field_current));
}

void exciter_derivative(MachineData const& d, Setpoints const& set, State const& x, double field_current, double v,
                        State& dx) {
    Avr const& r = *d.avr;
    dx[kVmeas] = lag(v, x[kVmeas], r.tr_s);
    if (r.ac8b) {
        ac8b_derivative(d, regulator_error(r, set, x), field_current, x, dx);
    } else {
        static_exciter_derivative(d, set, x, dx);
    }
    if (r.stabilizer) {
        Stabilizer const& s = *r.stabilizer;
        auto const outputs = stabilizer_outputs(s, x);
        dx[kWashout] = lag(s.gain * x[kSpeed], x[kWashout], s.washout_s);
        dx[kFirst] = lag(outputs.washed, x[kFirst], s.t2_s);
        dx[kSecond] = lag(outputs.first, x[kSecond], s.t4_s);
    }
}

void limit_exciter(MachineData const& d, Setpoints const& set, double v, State& x) {
    Avr const& r = *d.avr;
    if (r.tr_s == 0) {
        x[kVmeas] = v;
    }
    if (r.ac8b) {
        if (r.ta_s == 0) {
            x[kRegulator] = ac8b_regulator(d, regulator_error(r, set, x), x);
        }
        return;
    }
    if (r.ta_s == 0) {
        x[kEfd] = field_target(d, set, x);
    }
    x[kEfd] = std::clamp(x[kEfd], r.efd_min_pu, r.efd_max_pu);
}

void start_exciter(MachineData const& d, double efd, Setpoints& set, State& x) {
    Avr const& r = *d.avr;
    if (r.ac8b) {
        set.v_ref = x[kVmeas] + start_ac8b(d, efd, x);
        return;
    }
    set.v_ref = x[kVmeas] + efd / r.ka;
    if (r.tb_s > 0) {
        x[kLead] = efd / r.ka;
    }
    if (r.kf > 0) {
        x[kRate] = r.kf / r.tf_s * efd;
    }
}

} // namespace gridspace::sim::machines

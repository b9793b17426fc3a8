// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/ct/ct.hpp"

#include "sim/components/faces/number_specs.hpp"

#include <numbers>

namespace gridspace::sim {

using namespace elements;

void CtType::fields(Fields& f) {
    read_ratio(f, ratio, primary_a, secondary_a, "primary:secondary, in A", "for example \"400:5\"");
    f.number("error_percent", error_percent, any("ratio error"));
    filter.read(f, name.name);
    f.number("quantum_ma", quantum_ma, not_negative("values are rounded to whole quanta; 0: not"));
    f.object("saturation", {.doc = "two-slope core, seen from the secondary"}, [&](Fields& s) {
        CtSaturation& core = saturation.emplace();
        s.number("knee_v", core.knee_v, positive("r.m.s. secondary voltage at the knee, at base frequency", true));
        s.number("magnetising_ma", core.magnetising_ma, positive("r.m.s. secondary current at the knee", true));
        s.number("winding_ohm", core.winding_ohm, positive("resistance of the secondary winding", true));
        s.number("burden_ohm", core.burden_ohm, not_negative("resistance of leads and relay", true));
        s.number("air_core_mh", core.air_core_mh, positive("inductance beyond the knee", true));
        NumberSpec remanence = any("flux at the start, of that at the knee");
        remanence.min = -100;
        remanence.max = 100;
        s.number("remanence_percent", core.remanence_percent, remanence);
    });
}

void Ct::fields(Fields& f) {
    f.reference("line", line, {.doc = "the line whose current it measures", .required = true});
    line_end(f, end);
    f.reference("type", type, {.doc = "CT type", .required = true});
    f.choice<CtPolarity>("positive", positive, {{"from_to", CtPolarity::from_to}, {"into_line", CtPolarity::into_line}},
                         {.doc = "direction that counts positive"});
}

emt::InstrumentData Ct::data(Surroundings const& around) const {
    CtType const& t = *around.find<CtType>(type);
    bool const along = end == LineEnd::from || positive == CtPolarity::into_line;
    emt::InstrumentData d;
    d.factor = (along ? 1 : -1) * (1 + t.error_percent / 100);
    d.quantum = t.quantum_ma * 1e-3;
    d.cutoff_hz = t.filter.cutoff();
    if (t.saturation) {
        constexpr double kRoot2 = std::numbers::sqrt2;
        CtSaturation const& s = *t.saturation;
        double const knee = kRoot2 * s.knee_v / around.omega();
        d.core = {emt::InstrumentData::Core::Of::current,
                  {knee / (kRoot2 * s.magnetising_ma * 1e-3), s.air_core_mh * 1e-3, knee},
                  s.winding_ohm + s.burden_ohm,
                  t.primary_a / t.secondary_a,
                  knee * s.remanence_percent / 100};
    }
    return d;
}

} // namespace gridspace::sim

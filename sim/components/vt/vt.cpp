// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/vt/vt.hpp"

#include "sim/components/faces/number_specs.hpp"

#include <cmath>
#include <numbers>

namespace gridspace::sim {

using namespace elements;

void VtType::fields(Fields& f) {
    read_ratio(f, ratio, primary_v, secondary_v, "primary:secondary, in V", "for example \"12470:120\"");
    f.number("error_percent", error_percent, any("ratio error"));
    filter.read(f, name.name);
    f.number("quantum_mv", quantum_mv, not_negative("primary values are rounded to whole quanta; 0: not"));
    f.object("saturation", {.doc = "two-slope core, seen from the primary"}, [&](Fields& s) {
        VtSaturation& core = saturation.emplace();
        s.number("knee_pu", core.knee_pu, positive("flux linkage at the knee, of that of nominal voltage"));
        s.number("magnetising_ma", core.magnetising_ma, positive("r.m.s. primary current at the knee", true));
        s.number("winding_ohm", core.winding_ohm, positive("resistance of the primary winding", true));
        s.number("air_core_mh", core.air_core_mh, positive("inductance beyond the knee", true));
    });
}

void Vt::fields(Fields& f) {
    f.reference("bus", bus, {.doc = "the bus whose voltage it measures", .required = true});
    f.reference("type", type, {.doc = "VT type", .required = true});
}

emt::InstrumentData Vt::data(Surroundings const& around) const {
    VtType const& t = *around.find<VtType>(type);
    emt::InstrumentData d;
    d.factor = 1 + t.error_percent / 100;
    d.quantum = t.quantum_mv * 1e-3;
    d.cutoff_hz = t.filter.cutoff();
    if (t.saturation) {
        VtSaturation const& s = *t.saturation;
        double const knee = s.knee_pu * (around.voltage_v(bus) * std::sqrt(2.0 / 3)) / around.omega();
        d.core = {emt::InstrumentData::Core::Of::voltage,
                  {knee / (std::numbers::sqrt2 * s.magnetising_ma * 1e-3), s.air_core_mh * 1e-3, knee},
                  s.winding_ohm,
                  1,
                  0};
    }
    return d;
}

} // namespace gridspace::sim

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/element_config.hpp"

#include <charconv>
#include <fmt/format.h>

namespace gridspace::sim::elements {
namespace {

void line_end(Fields& f, LineEnd& end) {
    f.choice<LineEnd>("end", end, {{"from", LineEnd::from}, {"to", LineEnd::to}},
                      {.doc = "which end of the line", .required = true});
}

/// Primary and secondary value of an instrument transformer.
void ratio(Fields& f, std::string& text, double& primary, double& secondary, std::string_view doc,
           std::string const& example) {
    f.text("ratio", text, {.doc = doc});
    std::size_t const colon = text.find(':');
    auto const part = [](std::string_view digits, double& value) {
        auto const [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        return error == std::errc{} && end == digits.data() + digits.size() && value > 0;
    };
    if (colon == std::string::npos || !part(std::string_view{text}.substr(0, colon), primary) ||
        !part(std::string_view{text}.substr(colon + 1), secondary)) {
        f.error("ratio", fmt::format("'{}' is not a ratio", text), example);
    }
}

void instrument_filter(Fields& f, std::string const& name, double& error_percent, InstrumentFilter& filter,
                       double& cutoff_hz) {
    f.number("error_percent", error_percent, any("ratio error"));
    f.choice<InstrumentFilter>("filter", filter,
                               {{"none", InstrumentFilter::none}, {"butterworth2", InstrumentFilter::butterworth2}},
                               {.doc = "anti-alias filter"});
    f.number("cutoff_hz", cutoff_hz, positive("of the filter, -3 dB"));
    if ((filter == InstrumentFilter::none) != !f.has("cutoff_hz")) {
        f.error(f.has("cutoff_hz") ? "cutoff_hz" : "filter",
                filter == InstrumentFilter::none ? fmt::format("'{}' has a cutoff_hz but no filter", name)
                                                 : fmt::format("the filter of '{}' needs cutoff_hz", name),
                "filter: butterworth2 with cutoff_hz, or neither");
    }
}

} // namespace

void line_type(Fields& f, LineType& t) {
    f.numbers("phase_r_ohm_per_km", t.phase_r_ohm_per_km,
              not_negative("resistances aa, ab, bb, ac, bc, cc, instead of sequences"));
    f.numbers("phase_x_ohm_per_km", t.phase_x_ohm_per_km, any("reactances aa, ab, bb, ac, bc, cc"));
    bool const by_phase = f.has("phase_r_ohm_per_km") || f.has("phase_x_ohm_per_km");
    f.number("r_ohm_per_km", t.r_ohm_per_km, not_negative("resistance, positive sequence", !by_phase));
    f.number("x_ohm_per_km", t.x_ohm_per_km, not_negative("reactance at the base frequency"));
    f.number("l_mh_per_km", t.l_mh_per_km, not_negative("inductance, instead of a reactance"));
    f.number("c_nf_per_km", t.c_nf_per_km, not_negative("capacitance"));
    f.number("r0_ohm_per_km", t.r0_ohm_per_km, not_negative("resistance, zero sequence"));
    f.number("x0_ohm_per_km", t.x0_ohm_per_km, not_negative("reactance, zero sequence"));
    f.number("l0_mh_per_km", t.l0_mh_per_km, not_negative("inductance, zero sequence"));
    f.number("c0_nf_per_km", t.c0_nf_per_km, not_negative("capacitance, zero sequence"));
    if (by_phase) {
        if (t.phase_r_ohm_per_km.size() != 6 || t.phase_x_ohm_per_km.size() != 6) {
            f.error("",
                    fmt::format("line type '{}' needs six phase_r_ohm_per_km and six phase_x_ohm_per_km", t.name.name),
                    "the lower triangle: aa, ab, bb, ac, bc, cc");
            t.phase_r_ohm_per_km.clear();
            t.phase_x_ohm_per_km.clear();
        } else if (f.has("r_ohm_per_km") || t.x_ohm_per_km || t.l_mh_per_km || t.r0_ohm_per_km || t.x0_ohm_per_km ||
                   t.l0_mh_per_km) {
            f.error("phase_r_ohm_per_km",
                    fmt::format("line type '{}' has both phase and sequence impedances", t.name.name));
        } else {
            auto const own = [](std::vector<double> const& m) { return (m[0] + m[2] + m[5]) / 3; };
            auto const mutual = [](std::vector<double> const& m) { return (m[1] + m[3] + m[4]) / 3; };
            t.r_ohm_per_km = own(t.phase_r_ohm_per_km) - mutual(t.phase_r_ohm_per_km);
            t.x_ohm_per_km = own(t.phase_x_ohm_per_km) - mutual(t.phase_x_ohm_per_km);
            t.r0_ohm_per_km = own(t.phase_r_ohm_per_km) + 2 * mutual(t.phase_r_ohm_per_km);
            t.x0_ohm_per_km = own(t.phase_x_ohm_per_km) + 2 * mutual(t.phase_x_ohm_per_km);
        }
    } else if (t.x_ohm_per_km.has_value() == t.l_mh_per_km.has_value()) {
        f.error("", fmt::format("line type '{}' needs either x_ohm_per_km or l_mh_per_km", t.name.name));
    }
}

void line(Fields& f, Line& l) {
    f.reference("from", l.from, {.doc = "bus at the `from` end", .required = true});
    f.reference("to", l.to, {.doc = "bus at the `to` end", .required = true});
    f.reference("type", l.type, {.doc = "line type; with length_km"});
    f.number("length_km", l.length_km, positive("length, with a type"));
    f.number("r_ohm", l.r_ohm, not_negative("total resistance, instead of a type"));
    f.number("x_ohm", l.x_ohm, not_negative("total reactance at the base frequency"));
    f.number("l_mh", l.l_mh, not_negative("total inductance, instead of a reactance"));
    f.number("c_nf", l.c_nf, not_negative("total capacitance"));
    f.number("r0_ohm", l.r0_ohm, not_negative("total resistance, zero sequence"));
    f.number("x0_ohm", l.x0_ohm, not_negative("total reactance, zero sequence"));
    f.number("l0_mh", l.l0_mh, not_negative("total inductance, zero sequence"));
    f.number("c0_nf", l.c0_nf, not_negative("total capacitance, zero sequence"));
    f.choice<LineModel>("model", l.model, {{"pi", LineModel::pi}, {"bergeron", LineModel::bergeron}},
                        {.doc = "waveform model"});
    bool const totals = l.r_ohm || l.x_ohm || l.l_mh;
    if (!l.type.empty() && totals) {
        f.error("type", fmt::format("line '{}' has both a type and total values", l.name.name),
                "give a type and length_km, or r_ohm and l_mh (or x_ohm)");
    } else if (l.type.empty() && !totals) {
        f.error("", fmt::format("line '{}' has no impedance", l.name.name),
                "give a type and length_km, or r_ohm and l_mh (or x_ohm)");
    } else if (!l.type.empty() && !f.has("length_km")) {
        f.error("type", fmt::format("line '{}' has a type but no length_km", l.name.name));
    } else if (l.x_ohm && l.l_mh) {
        f.error("l_mh", fmt::format("line '{}' has both x_ohm and l_mh", l.name.name));
    }
}

void transformer(Fields& f, Transformer& t) {
    f.reference("from", t.from, {.doc = "bus of the first winding", .required = true});
    f.reference("to", t.to, {.doc = "bus of the second winding", .required = true});
    f.number("rating_kva", t.rating_kva, positive("rated power", true));
    f.number("r_percent", t.r_percent, not_negative("short-circuit resistance, of the rating"));
    f.number("x_percent", t.x_percent, not_negative("short-circuit reactance, of the rating", true));
    f.number("tap_ratio", t.tap_ratio, positive("off-nominal ratio at the first winding"));
    f.number("phase_shift_deg", t.phase_shift_deg, any("the second winding lags by it"));
    auto const winding = [&](std::string_view key, Winding& w, std::string_view doc) {
        f.choice<Winding>(key, w,
                          {{"wye_grounded", Winding::wye_grounded}, {"wye", Winding::wye}, {"delta", Winding::delta}},
                          {.doc = doc});
    };
    winding("from_winding", t.from_winding, "connection of the first winding");
    winding("to_winding", t.to_winding, "connection of the second winding");
    f.number("magnetising_percent", t.magnetising_percent, percent("magnetising current, of the rated current"));
    f.number("charging_percent", t.charging_percent, any("shunt susceptance, half at each winding, of the rating"));
    f.object("saturation", {.doc = "two-slope saturation of the core"}, [&](Fields& s) {
        Transformer::Saturation& saturation = t.saturation.emplace();
        s.number("knee_pu", saturation.knee_pu, positive("flux linkage at the knee"));
        s.number("air_core_percent", saturation.air_core_percent, positive("reactance above the knee, of the rating"));
        if (t.magnetising_percent == 0) {
            s.error("", fmt::format("transformer '{}' saturates but has no magnetising current", t.name.name),
                    "give magnetising_percent");
        }
    });
}

void breaker_type(Fields& f, BreakerType& t) {
    using Opens = BreakerType::Opens;
    f.number("mechanism_ms", t.mechanism_ms, not_negative("from the command to the parting of the contacts"));
    f.choice<Opens>("opens", t.opens,
                    {{"each_pole_at_current_zero", Opens::each_pole_at_current_zero}, {"at_once", Opens::at_once}},
                    {.doc = "when the current stops"});
    f.number("chop_a", t.chop_a, not_negative("a pole that opens interrupts a current that has fallen to this, in A"));
    if (t.chop_a > 0 && t.opens == Opens::at_once) {
        f.error("chop_a", fmt::format("breaker type '{}' opens at once and chops every current", t.name.name),
                "leave out one of `chop_a` and `opens: at_once`");
    }
    f.flag("latched", t.latched, {.doc = "a false trip signal never closes it"});
}

void breaker(Fields& f, Breaker& b) {
    f.reference("line", b.line, {.doc = "the line that it switches", .required = true});
    line_end(f, b.end);
    f.reference("type", b.type, {.doc = "breaker type", .required = true});
    f.choice<bool>("state", b.closed, {{"closed", true}, {"open", false}}, {.doc = "state at the start"});
}

void ct_type(Fields& f, CtType& t) {
    ratio(f, t.ratio, t.primary_a, t.secondary_a, "primary:secondary, in A", "for example \"400:5\"");
    instrument_filter(f, t.name.name, t.error_percent, t.filter, t.cutoff_hz);
    f.number("quantum_ma", t.quantum_ma, not_negative("values are rounded to whole quanta; 0: not"));
    f.object("saturation", {.doc = "two-slope core, seen from the secondary"}, [&](Fields& s) {
        CtSaturation& core = t.saturation.emplace();
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

void vt_type(Fields& f, VtType& t) {
    ratio(f, t.ratio, t.primary_v, t.secondary_v, "primary:secondary, in V", "for example \"12470:120\"");
    instrument_filter(f, t.name.name, t.error_percent, t.filter, t.cutoff_hz);
    f.number("quantum_mv", t.quantum_mv, not_negative("primary values are rounded to whole quanta; 0: not"));
    f.object("saturation", {.doc = "two-slope core, seen from the primary"}, [&](Fields& s) {
        VtSaturation& core = t.saturation.emplace();
        s.number("knee_pu", core.knee_pu, positive("flux linkage at the knee, of that of nominal voltage"));
        s.number("magnetising_ma", core.magnetising_ma, positive("r.m.s. primary current at the knee", true));
        s.number("winding_ohm", core.winding_ohm, positive("resistance of the primary winding", true));
        s.number("air_core_mh", core.air_core_mh, positive("inductance beyond the knee", true));
    });
}

void vt(Fields& f, Vt& v) {
    f.reference("bus", v.bus, {.doc = "the bus whose voltage it measures", .required = true});
    f.reference("type", v.type, {.doc = "VT type", .required = true});
}

void ct(Fields& f, Ct& c) {
    f.reference("line", c.line, {.doc = "the line whose current it measures", .required = true});
    line_end(f, c.end);
    f.reference("type", c.type, {.doc = "CT type", .required = true});
    f.choice<CtPolarity>("positive", c.positive,
                         {{"from_to", CtPolarity::from_to}, {"into_line", CtPolarity::into_line}},
                         {.doc = "direction that counts positive"});
}

} // namespace gridspace::sim::elements

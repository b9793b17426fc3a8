// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/network_config.hpp"

#include "common/config/merge.hpp"
#include "common/config/yaml.hpp"
#include "common/text.hpp"
#include "sim/network/matpower.hpp"
#include "sim/network/network_check.hpp"
#include "sim/network/profile_csv.hpp"

#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim {
namespace {

using config::Fields;
using config::NumberSpec;

constexpr NumberSpec positive(std::string_view doc, bool required = false) {
    NumberSpec spec;
    spec.doc = doc;
    spec.required = required;
    spec.above = 0;
    return spec;
}
constexpr NumberSpec not_negative(std::string_view doc, bool required = false) {
    NumberSpec spec;
    spec.doc = doc;
    spec.required = required;
    spec.min = 0;
    return spec;
}
constexpr NumberSpec any(std::string_view doc, bool required = false) {
    NumberSpec spec;
    spec.doc = doc;
    spec.required = required;
    return spec;
}
constexpr NumberSpec percent(std::string_view doc, bool required = false) {
    NumberSpec spec = not_negative(doc, required);
    spec.max = 100;
    return spec;
}

/// A section that maps names to elements: each is appended with its name.
template <class T>
void section(Fields& f, std::string_view key, std::string_view doc, std::vector<T>& elements,
             void (*one)(Fields&, T&)) {
    f.map(key, {.doc = doc}, [&](Ref const& name, Fields& e) {
        T element;
        element.name = name;
        e.text("label", element.label, {.doc = "text for displays; the name when not given"});
        one(e, element);
        elements.push_back(std::move(element));
    });
}

void bus(Fields& f, Bus& b) {
    f.number("voltage_v", b.voltage_v, positive("nominal voltage, line to line, r.m.s.", true));
    f.object("diagram", {.doc = "place in the one-line diagram"}, [&](Fields& d) {
        d.number("x", b.diagram_x, any("column"));
        d.number("y", b.diagram_y, any("row, downwards"));
    });
}

void source(Fields& f, Source& s) {
    f.reference("bus", s.bus, {.doc = "its bus", .required = true});
    f.number("voltage_pu", s.voltage_pu, not_negative("internal voltage"));
    f.number("angle_deg", s.angle_deg, any("angle of phase a"));
    f.number("r_ohm", s.r_ohm, not_negative("resistance, positive sequence"));
    f.number("l_mh", s.l_mh, not_negative("inductance, positive sequence"));
    f.number("r0_ohm", s.r0_ohm, not_negative("resistance, zero sequence"));
    f.number("l0_mh", s.l0_mh, not_negative("inductance, zero sequence"));
    f.list("harmonics", {.doc = "harmonics of the internal voltage"}, [&](Fields& h) {
        Source::Harmonic harmonic;
        h.integer("order", harmonic.order, {.doc = "order", .required = true, .min = 2});
        h.number("percent", harmonic.percent, not_negative("amplitude, of the fundamental", true));
        h.number("angle_deg", harmonic.angle_deg, any("angle of phase a"));
        s.harmonics.push_back(harmonic);
    });
}

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
    f.flag("latched", t.latched, {.doc = "a false trip signal never closes it"});
}

void line_end(Fields& f, LineEnd& end) {
    f.choice<LineEnd>("end", end, {{"from", LineEnd::from}, {"to", LineEnd::to}},
                      {.doc = "which end of the line", .required = true});
}

void breaker(Fields& f, Breaker& b) {
    f.reference("line", b.line, {.doc = "the line that it switches", .required = true});
    line_end(f, b.end);
    f.reference("type", b.type, {.doc = "breaker type", .required = true});
    f.choice<bool>("state", b.closed, {{"closed", true}, {"open", false}}, {.doc = "state at the start"});
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

void governor(Fields& f, Governor& g) {
    f.number("droop_percent", g.droop_percent, positive("frequency drop at full power"));
    f.number("tg_s", g.tg_s, not_negative("servo time constant"));
    f.number("tt_s", g.tt_s, not_negative("turbine time constant"));
    f.number("integral_ki", g.integral_ki, not_negative("integral gain; 0: droop only"));
}

void machine_type(Fields& f, MachineType& t) {
    f.choice<MachineModel>("model", t.model, {{"full", MachineModel::full}, {"classical", MachineModel::classical}},
                           {.doc = "rotor circuits, or constant voltage behind xd1"});
    bool const full = t.model == MachineModel::full;
    f.object(
        "constants_pu", {.doc = "reactances and resistance on the machine's rating", .required = true}, [&](Fields& c) {
            c.number("xd", t.pu.xd, positive("synchronous, d", full));
            c.number("xq", t.pu.xq, positive("synchronous, q", full));
            c.number("xd1", t.pu.xd1, positive("transient, d", true));
            c.number("xd2", t.pu.xd2, positive("subtransient, d", full));
            c.number("xq2", t.pu.xq2, positive("subtransient, q", full));
            c.number("xl", t.pu.xl, positive("leakage", full));
            c.number("x0", t.pu.x0, not_negative("zero sequence; 0: star point not earthed"));
            c.number("ra", t.pu.ra, not_negative("armature resistance"));
            auto const order = [&](std::string_view small_key, double small, std::string_view large_key, double large) {
                if (full && small > 0 && large > 0 && small >= large) {
                    c.error(small_key,
                            fmt::format("{} = {} of '{}' is not below {} = {}", small_key, shortest(small), t.name.name,
                                        large_key, shortest(large)),
                            "xl < xd2 <= xd1 <= xd and xl < xq2 <= xq");
                }
            };
            order("xl", t.pu.xl, "xd2", t.pu.xd2);
            order("xl", t.pu.xl, "xq2", t.pu.xq2);
            order("xd2", t.pu.xd2, "xd1", t.pu.xd1 * (1 + 1e-12));
            order("xd1", t.pu.xd1, "xd", t.pu.xd * (1 + 1e-12));
            order("xq2", t.pu.xq2, "xq", t.pu.xq * (1 + 1e-12));
        });
    f.object("times_s", {.doc = "open-circuit time constants", .required = full}, [&](Fields& c) {
        c.number("td01", t.td01_s, positive("transient, d", full));
        c.number("td02", t.td02_s, positive("subtransient, d", full));
        c.number("tq02", t.tq02_s, positive("subtransient, q", full));
    });
    f.number("inertia_h_s", t.inertia_h_s, positive("inertia constant", true));
    f.number("damping_pu", t.damping_pu, not_negative("damping torque per p.u. speed"));
    f.object("avr", {.doc = "voltage regulator"}, [&](Fields& a) {
        Avr& avr = t.avr.emplace();
        a.number("ka", avr.ka, positive("gain", true));
        a.number("ta_s", avr.ta_s, not_negative("time constant"));
        a.number("tr_s", avr.tr_s, not_negative("measuring time constant"));
        a.number("efd_min_pu", avr.efd_min_pu, any("lower limit of the field voltage"));
        a.number("efd_max_pu", avr.efd_max_pu, any("upper limit of the field voltage", true));
    });
    f.object("governor", {.doc = "speed governor and turbine"}, [&](Fields& g) { governor(g, t.governor.emplace()); });
}

void machine(Fields& f, Machine& m) {
    f.reference("bus", m.bus, {.doc = "its bus", .required = true});
    f.reference("type", m.type, {.doc = "machine type", .required = true});
    f.number("rating_kva", m.rating_kva, positive("rated power", true));
    f.number("p_kw", m.p_kw, any("power at the start", true));
    f.number("voltage_setpoint_pu", m.voltage_setpoint_pu, positive("terminal voltage at the start"));
    f.number("inertia_h_s", m.inertia_h_s, positive("overrides the type's"));
    f.object("governor", {.doc = "overrides the type's"}, [&](Fields& g) { governor(g, m.governor.emplace()); });
}

void generator(Fields& f, Generator& g) {
    f.reference("bus", g.bus, {.doc = "its bus", .required = true});
    f.number("rating_kva", g.rating_kva, not_negative("rated power"));
    f.choice<GeneratorRole>("role", g.role,
                            {{"slack", GeneratorRole::slack}, {"pv", GeneratorRole::pv}, {"pq", GeneratorRole::pq}},
                            {.doc = "what it holds: voltage and angle, power and voltage, or powers"});
    f.number("voltage_setpoint_pu", g.voltage_setpoint_pu, positive("held voltage (slack, pv)"));
    f.number("angle_deg", g.angle_deg, any("held angle (slack)"));
    f.number("p_kw", g.p_kw, any("active power (pv, pq)"));
    f.number("q_kvar", g.q_kvar, any("reactive power (pq)"));
    f.number("q_min_kvar", g.q_min_kvar, any("least reactive power"));
    f.number("q_max_kvar", g.q_max_kvar, any("most reactive power"));
}

void load(Fields& f, Load& l) {
    f.reference("bus", l.bus, {.doc = "its bus", .required = true});
    f.numbers("phase_p_kw", l.phase_p_kw, any("active powers of phases a, b, c at 1 p.u., instead of p_kw"));
    f.numbers("phase_q_kvar", l.phase_q_kvar, any("reactive powers of phases a, b, c at 1 p.u."));
    bool const by_phase = f.has("phase_p_kw") || f.has("phase_q_kvar");
    f.number("p_kw", l.p_kw, any("active power at 1 p.u.", !by_phase));
    NumberSpec factor = positive("lagging; instead of q_kvar");
    factor.max = 1;
    f.number("power_factor", l.power_factor, factor);
    f.number("q_kvar", l.q_kvar, any("reactive power at 1 p.u.; instead of a power factor"));
    f.choice<LoadModel>("model", l.model,
                        {{"constant_power", LoadModel::constant_power},
                         {"constant_current", LoadModel::constant_current},
                         {"constant_impedance", LoadModel::constant_impedance},
                         {"exponential", LoadModel::exponential},
                         {"zip", LoadModel::zip},
                         {"dc_resistive", LoadModel::dc_resistive},
                         {"dc_constant_power", LoadModel::dc_constant_power}},
                        {.doc = "how it depends on voltage"});
    f.number("exponent_p", l.exponent_p, any("P = p (V/1)^exponent (exponential)"));
    f.number("exponent_q", l.exponent_q, any("Q = q (V/1)^exponent (exponential)"));
    auto const shares = [&](std::string_view key, std::array<double, 3>& target, std::string_view doc) {
        std::vector<double> given;
        f.numbers(key, given, any(doc));
        if (given.size() == 3) {
            target = {given[0], given[1], given[2]};
            double const sum = given[0] + given[1] + given[2];
            if (sum < 0.999 || sum > 1.001) {
                f.error(key, fmt::format("the shares of '{}' add up to {}, not 1", l.name.name, sum));
            }
        } else if (f.has(key)) {
            f.error(key, fmt::format("expected three shares, found {}", given.size()),
                    "[constant impedance, constant current, constant power]");
        }
    };
    shares("zip_p", l.zip_p, "shares of P: constant impedance, current, power (zip)");
    shares("zip_q", l.zip_q, "shares of Q: constant impedance, current, power (zip)");
    f.number("lag_s", l.lag_s, not_negative("first-order lag of the power; 0: none"));
    f.reference("scale", l.scale, {.doc = "profile that multiplies the power"});
    if (by_phase) {
        if (l.phase_p_kw.size() != 3 || l.phase_q_kvar.size() != 3) {
            f.error("", fmt::format("load '{}' needs three phase_p_kw and three phase_q_kvar", l.name.name),
                    "[a, b, c]");
            l.phase_p_kw.clear();
            l.phase_q_kvar.clear();
        } else if (f.has("p_kw") || f.has("q_kvar") || f.has("power_factor")) {
            f.error("phase_p_kw", fmt::format("load '{}' has both powers by phase and of all phases", l.name.name));
        } else {
            l.p_kw = l.phase_p_kw[0] + l.phase_p_kw[1] + l.phase_p_kw[2];
            l.q_kvar = l.phase_q_kvar[0] + l.phase_q_kvar[1] + l.phase_q_kvar[2];
        }
    }
    if (f.has("q_kvar") && f.has("power_factor")) {
        f.error("q_kvar", fmt::format("load '{}' has both q_kvar and power_factor", l.name.name));
    }
}

void shunt(Fields& f, Shunt& s) {
    f.reference("bus", s.bus, {.doc = "its bus", .required = true});
    f.number("p_kw", s.p_kw, any("active power consumed at 1 p.u."));
    f.number("q_kvar", s.q_kvar, any("reactive power produced at 1 p.u."));
}

void pv(Fields& f, Pv& p) {
    f.reference("bus", p.bus, {.doc = "its bus", .required = true});
    f.number("p_kw", p.p_kw, not_negative("power at full sun", true));
    f.number("rating_kva", p.rating_kva, not_negative("apparent power that it cannot exceed; 0: no limit"));
    NumberSpec factor = positive("of the inverter");
    factor.max = 1;
    f.number("power_factor", p.power_factor, factor);
    f.reference("scale", p.scale, {.doc = "profile of the sun"});
}

void ev(Fields& f, Ev& e) {
    f.reference("bus", e.bus, {.doc = "its bus", .required = true});
    f.number("capacity_kwh", e.capacity_kwh, positive("energy of the battery", true));
    f.number("battery_v", e.battery_v, positive("voltage of the battery", true));
    f.number("max_current_a", e.max_current_a, positive("most battery current", true));
    NumberSpec efficiency = positive("battery power over power from the grid");
    efficiency.max = 1;
    f.number("efficiency", e.efficiency, efficiency);
    f.number("soc_start_percent", e.soc_start_percent, percent("state of charge at the start", true));
    f.number("soc_stop_percent", e.soc_stop_percent, percent("charging stops exactly here"));
    f.number("current_lag_s", e.current_lag_s, not_negative("response time of the converter"));
    if (e.soc_stop_percent < e.soc_start_percent) {
        f.error("soc_stop_percent", fmt::format("'{}' stops at {} %, below its start at {} %", e.name.name,
                                                e.soc_stop_percent, e.soc_start_percent));
    }
}

void battery(Fields& f, Battery& b) {
    f.reference("bus", b.bus, {.doc = "its bus", .required = true});
    f.number("capacity_kwh", b.capacity_kwh, positive("energy of the cells", true));
    f.number("rating_kva", b.rating_kva, positive("rated power of the converter", true));
    f.number("p_kw", b.p_kw, any("power into the network; negative: charging"));
    f.number("q_kvar", b.q_kvar, any("reactive power into the network"));
    NumberSpec efficiency = positive("of the converter, each way");
    efficiency.max = 1;
    f.number("efficiency", b.efficiency, efficiency);
    f.number("soc_start_percent", b.soc_start_percent, percent("state of charge at the start"));
    f.number("soc_min_percent", b.soc_min_percent, percent("discharging stops exactly here"));
    f.number("soc_max_percent", b.soc_max_percent, percent("charging stops exactly here"));
    f.reference("scale", b.scale, {.doc = "profile that multiplies p_kw"});
    if (!(b.soc_min_percent <= b.soc_start_percent && b.soc_start_percent <= b.soc_max_percent)) {
        f.error("soc_start_percent", fmt::format("'{}' starts at {} %, which is not between {} % and {} %", b.name.name,
                                                 b.soc_start_percent, b.soc_min_percent, b.soc_max_percent));
    }
    if (b.rating_kva > 0 && std::hypot(b.p_kw, b.q_kvar) > b.rating_kva * (1 + 1e-9)) {
        f.error("rating_kva", fmt::format("p_kw and q_kvar of '{}' are {:.4g} kVA, more than its rating", b.name.name,
                                          std::hypot(b.p_kw, b.q_kvar)));
    }
}

void profile(Fields& f, Profile& p) {
    using Time = Profile::Time;
    f.choice<Time>("time", p.time, {{"since_start", Time::since_start}, {"hour_of_day", Time::hour_of_day}},
                   {.doc = "what the hours count from"});
    f.numbers("hours", p.hours, any("times of the points, increasing"));
    f.numbers("values", p.values, any("values at the points; linear between them"));
    std::filesystem::path csv;
    std::string column;
    f.file("csv", csv, {.doc = "file with a column hours and others, instead of points"});
    f.text("column", column, {.doc = "column of the file"});
    f.object("half_sine", {.doc = "sin(pi (h - rise) / (set - rise)) ^ exponent by day, else 0"}, [&](Fields& h) {
        Profile::HalfSine& sine = p.half_sine.emplace();
        h.number("rise_h", sine.rise_h, any("sunrise", true));
        h.number("set_h", sine.set_h, any("sunset", true));
        h.number("exponent", sine.exponent, positive("1: a sine"));
        if (sine.set_h <= sine.rise_h) {
            h.error("set_h", "the sun sets before it rises");
        }
    });
    f.list("clouds", {.doc = "dips: times (1 - depth exp(-((h - at) / width)^2))"}, [&](Fields& c) {
        Profile::Cloud cloud;
        c.number("at_h", cloud.at_h, any("middle", true));
        c.number("depth_percent", cloud.depth_percent, percent("depth", true));
        c.number("width_h", cloud.width_h, positive("width", true));
        p.clouds.push_back(cloud);
    });
    if (!csv.empty()) {
        if (auto read = read_profile_csv(csv, column); read) {
            p.hours = std::move(read->hours);
            p.values = std::move(read->values);
        } else {
            f.error("csv", read.error().message, read.error().remedy);
        }
    }
    int const kinds = (p.hours.empty() ? 0 : 1) + (p.half_sine ? 1 : 0);
    if (kinds != 1 && !f.has("csv")) {
        f.error("", fmt::format("profile '{}' needs points (hours and values), a csv, or a half_sine", p.name.name));
    }
    if (p.hours.size() != p.values.size()) {
        f.error("values",
                fmt::format("profile '{}' has {} hours and {} values", p.name.name, p.hours.size(), p.values.size()));
    }
    for (std::size_t i = 1; i < p.hours.size(); ++i) {
        if (p.hours[i] <= p.hours[i - 1]) {
            f.error("hours", fmt::format("the hours of profile '{}' do not increase at {}", p.name.name, p.hours[i]));
            break;
        }
    }
}

} // namespace

void describe(Fields& f, Network& n) {
    n.where = f.where();
    std::int64_t version = 1;
    f.integer("gridspace_network", version, {.doc = "version of this format", .required = true, .min = 1, .max = 1});
    f.text("name", n.name, {.doc = "name of the network", .required = true});
    std::string description;
    f.text("description", description, {.doc = "what it is"});
    f.object("base", {.doc = "base values", .required = true}, [&](Fields& b) {
        b.number("frequency_hz", n.frequency_hz, positive("nominal frequency", true));
        b.number("power_kva", n.power_kva, positive("base power", true));
    });
    section(f, "buses", "buses", n.buses, bus);
    section(f, "sources", "stiff networks behind an impedance", n.sources, source);
    section(f, "line_types", "line data per km", n.line_types, line_type);
    section(f, "lines", "lines", n.lines, line);
    section(f, "transformers", "two-winding transformers", n.transformers, transformer);
    section(f, "breaker_types", "breaker data", n.breaker_types, breaker_type);
    section(f, "breakers", "breakers at line ends", n.breakers, breaker);
    section(f, "ct_types", "current transformer data", n.ct_types, ct_type);
    section(f, "cts", "current transformers at line ends", n.cts, ct);
    section(f, "vt_types", "voltage transformer data", n.vt_types, vt_type);
    section(f, "vts", "voltage transformers at buses", n.vts, vt);
    section(f, "machine_types", "synchronous machine data", n.machine_types, machine_type);
    section(f, "machines", "synchronous machines", n.machines, machine);
    section(f, "generators", "generators without dynamics", n.generators, generator);
    section(f, "loads", "loads", n.loads, load);
    section(f, "shunts", "shunts", n.shunts, shunt);
    section(f, "pv", "photovoltaic inverters", n.pv, pv);
    section(f, "evs", "electric vehicles", n.evs, ev);
    section(f, "batteries", "stationary batteries", n.batteries, battery);
    section(f, "profiles", "values over time", n.profiles, profile);
}

std::optional<Network> read_network(config::Node const& root, config::Diagnostics& diagnostics) {
    Network network;
    int const before = diagnostics.errors();
    config::read_fields(root, "", diagnostics, [&](Fields& f) { describe(f, network); });
    if (diagnostics.errors() == before) {
        check_network(network, diagnostics);
    }
    return diagnostics.errors() == before ? std::optional{std::move(network)} : std::nullopt;
}

std::optional<Network> load_network(std::filesystem::path const& file, config::Diagnostics& diagnostics,
                                    config::SourceMark named_at) {
    if (file.extension() == ".m") {
        return load_matpower(file, diagnostics, std::move(named_at));
    }
    std::optional<config::Node> const root = config::load_extended(file, diagnostics, named_at);
    return root ? read_network(*root, diagnostics) : std::nullopt;
}

} // namespace gridspace::sim

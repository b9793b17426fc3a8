// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/line/line.hpp"

#include "common/text.hpp"
#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/shared_checks.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>

/// Keys and data of a line. What solvers make of it: line_solvers.cpp.
namespace gridspace::sim {

using namespace elements;

void LineType::fields(Fields& f) {
    f.numbers("phase_r_ohm_per_km", phase_r_ohm_per_km,
              not_negative("resistances aa, ab, bb, ac, bc, cc, instead of sequences"));
    f.numbers("phase_x_ohm_per_km", phase_x_ohm_per_km, any("reactances aa, ab, bb, ac, bc, cc"));
    tower.fields(f);
    table.fields(f);
    bool const given_by_phase = f.has("phase_r_ohm_per_km") || f.has("phase_x_ohm_per_km");
    f.number("r_ohm_per_km", r_ohm_per_km,
             not_negative("resistance, positive sequence", !given_by_phase && !by_frequency()));
    f.number("x_ohm_per_km", x_ohm_per_km, not_negative("reactance at the base frequency"));
    f.number("l_mh_per_km", l_mh_per_km, not_negative("inductance, instead of a reactance"));
    f.number("c_nf_per_km", c_nf_per_km, not_negative("capacitance"));
    f.number("r0_ohm_per_km", r0_ohm_per_km, not_negative("resistance, zero sequence"));
    f.number("x0_ohm_per_km", x0_ohm_per_km, not_negative("reactance, zero sequence"));
    f.number("l0_mh_per_km", l0_mh_per_km, not_negative("inductance, zero sequence"));
    f.number("c0_nf_per_km", c0_nf_per_km, not_negative("capacitance, zero sequence"));
    if (by_frequency()) {
        std::string_view const given = tower.given() ? "conductors" : "by_frequency";
        for (std::string_view const key :
             {"phase_r_ohm_per_km", "phase_x_ohm_per_km", "r_ohm_per_km", "x_ohm_per_km", "l_mh_per_km",
              "r0_ohm_per_km", "x0_ohm_per_km", "l0_mh_per_km", "c_nf_per_km", "c0_nf_per_km", "by_frequency"}) {
            if (f.has(key) && key != given && (tower.given() || !key.starts_with("c"))) {
                f.error(key, fmt::format("line type '{}' has both {} and {}", name.name, given, key));
            }
        }
    } else if (given_by_phase) {
        if (phase_r_ohm_per_km.size() != 6 || phase_x_ohm_per_km.size() != 6) {
            f.error("",
                    fmt::format("line type '{}' needs six phase_r_ohm_per_km and six phase_x_ohm_per_km", name.name),
                    "the lower triangle: aa, ab, bb, ac, bc, cc");
            phase_r_ohm_per_km.clear();
            phase_x_ohm_per_km.clear();
        } else if (f.has("r_ohm_per_km") || x_ohm_per_km || l_mh_per_km || r0_ohm_per_km || x0_ohm_per_km ||
                   l0_mh_per_km) {
            f.error("phase_r_ohm_per_km",
                    fmt::format("line type '{}' has both phase and sequence impedances", name.name));
        } else {
            auto const own = [](std::vector<double> const& m) { return (m[0] + m[2] + m[5]) / 3; };
            auto const mutual = [](std::vector<double> const& m) { return (m[1] + m[3] + m[4]) / 3; };
            r_ohm_per_km = own(phase_r_ohm_per_km) - mutual(phase_r_ohm_per_km);
            x_ohm_per_km = own(phase_x_ohm_per_km) - mutual(phase_x_ohm_per_km);
            r0_ohm_per_km = own(phase_r_ohm_per_km) + 2 * mutual(phase_r_ohm_per_km);
            x0_ohm_per_km = own(phase_x_ohm_per_km) + 2 * mutual(phase_x_ohm_per_km);
        }
    } else if (x_ohm_per_km.has_value() == l_mh_per_km.has_value()) {
        f.error("", fmt::format("line type '{}' needs either x_ohm_per_km or l_mh_per_km", name.name));
    }
    if (f.has("earth_ohm_m") && !tower.given()) {
        f.error("earth_ohm_m", fmt::format("line type '{}' has no conductors over its earth", name.name));
    }
}

void LineType::check(ElementCheck& check) const {
    if (std::string const what = mistake(); !what.empty()) {
        check.wrong(
            "is no line: " + what,
            tower.given()
                ? "each phase needs a conductor at a place of its own"
                : "by_frequency needs as many r, l, r0 and l0 as hz, from one line, and the type its c_nf_per_km");
    }
}

std::string LineType::mistake() const {
    if (tower.given()) {
        return tower.mistake();
    }
    if (!table.given()) {
        return {};
    }
    return c_nf_per_km > 0 && c0_nf_per_km.value_or(c_nf_per_km) > 0 ? table.mistake() : "it has no capacitance";
}

SequencesPerMetre LineType::per_metre(double omega) const {
    if (tower.given()) {
        return tower.per_metre(omega);
    }
    SequencesPerMetre out = table.per_metre(omega);
    out.c1_f = 1e-12 * c_nf_per_km;
    out.c0_f = 1e-12 * c0_nf_per_km.value_or(c_nf_per_km);
    return out;
}

void Line::fields(Fields& f) {
    f.reference("type", type, {.doc = "line type; with length_km"});
    f.number("length_km", length_km, positive("length, with a type"));
    f.number("r_ohm", r_ohm, not_negative("total resistance, instead of a type"));
    f.number("x_ohm", x_ohm, not_negative("total reactance at the base frequency"));
    f.number("l_mh", l_mh, not_negative("total inductance, instead of a reactance"));
    f.number("c_nf", c_nf, not_negative("total capacitance"));
    f.number("r0_ohm", r0_ohm, not_negative("total resistance, zero sequence"));
    f.number("x0_ohm", x0_ohm, not_negative("total reactance, zero sequence"));
    f.number("l0_mh", l0_mh, not_negative("total inductance, zero sequence"));
    f.number("c0_nf", c0_nf, not_negative("total capacitance, zero sequence"));
    f.choice<LineModel>("model", model,
                        {{"pi", LineModel::pi},
                         {"bergeron", LineModel::bergeron},
                         {"frequency_dependent", LineModel::frequency_dependent}},
                        {.doc = "waveform model"});
    f.numbers("fault_places_percent", fault_places_percent,
              {.doc = "of a frequency-dependent line: where inside a fault can be, from its `from` end",
               .above = 0,
               .below = 100});
    if (!fault_places_percent.empty() && model != LineModel::frequency_dependent) {
        f.error("fault_places_percent",
                fmt::format("line '{}' is not frequency dependent: a fault can be anywhere in it", name.name),
                "leave it out");
    } else if (std::ranges::adjacent_find(fault_places_percent, std::greater_equal<>{}) != fault_places_percent.end()) {
        f.error("fault_places_percent", fmt::format("line '{}' has places of faults that do not rise", name.name));
    }
    bool const totals = r_ohm || x_ohm || l_mh;
    if (!type.empty() && totals) {
        f.error("type", fmt::format("line '{}' has both a type and total values", name.name),
                "give a type and length_km, or r_ohm and l_mh (or x_ohm)");
    } else if (type.empty() && !totals) {
        f.error("", fmt::format("line '{}' has no impedance", name.name),
                "give a type and length_km, or r_ohm and l_mh (or x_ohm)");
    } else if (!type.empty() && !f.has("length_km")) {
        f.error("type", fmt::format("line '{}' has a type but no length_km", name.name));
    } else if (x_ohm && l_mh) {
        f.error("l_mh", fmt::format("line '{}' has both x_ohm and l_mh", name.name));
    }
}

void Line::check(ElementCheck& check) const {
    Surroundings const& around = check.around();
    if (!type.empty() && !check.exists(LineType::kKind, type)) {
        return;
    }
    LineType const* const own = around.find<LineType>(type);
    if (own != nullptr && !own->mistake().empty()) {
        return; // its type says it
    }
    if (model == LineModel::frequency_dependent && (own == nullptr || !own->by_frequency())) {
        check.wrong("is frequency dependent, but nothing says how",
                    "give it a type with `conductors` or `by_frequency`, or use `model: bergeron`");
    }
    bool const ends = around.element("buses", from) != nullptr && around.element("buses", to) != nullptr;
    if (ends && !(from == to) && around.voltage_v(from) != around.voltage_v(to)) {
        check.wrong(fmt::format("joins buses of {} V and {} V", shortest(around.voltage_v(from)),
                                shortest(around.voltage_v(to))),
                    "buses of different voltage need a transformer");
    }
    LineTotals const t = totals(around);
    if (t.r_ohm == 0 && t.l_h == 0) {
        check.wrong("has no impedance", "make it one bus, or give it a small resistance");
    } else if (t.r0_ohm == 0 && t.l0_h == 0) {
        check.wrong("has no zero sequence impedance",
                    "leave out r0_ohm and l0_mh (x0_ohm) to take those of the positive sequence");
    } else {
        double const omega = around.omega();
        check_least_impedance(check, from, std::hypot(t.r_ohm, omega * t.l_h), std::hypot(t.r0_ohm, omega * t.l0_h));
    }
}

LineTotals Line::totals(Surroundings const& around) const {
    double const omega = around.omega();
    LineTotals t;
    if (LineType const* per_km = around.find<LineType>(type); per_km != nullptr) {
        double const km = length_km.value_or(0);
        if (per_km->by_frequency()) {
            SequencesPerMetre const s = per_km->per_metre(omega);
            double const m = 1e3 * km;
            return {s.z1_ohm.real() * m, s.z1_ohm.imag() / omega * m, s.c1_f * m,
                    s.z0_ohm.real() * m, s.z0_ohm.imag() / omega * m, s.c0_f * m};
        }
        t.r_ohm = per_km->r_ohm_per_km * km;
        t.l_h = per_km->l_mh_per_km ? *per_km->l_mh_per_km * 1e-3 * km : per_km->x_ohm_per_km.value_or(0) / omega * km;
        t.c_f = per_km->c_nf_per_km * 1e-9 * km;
        t.r0_ohm = per_km->r0_ohm_per_km ? *per_km->r0_ohm_per_km * km : t.r_ohm;
        t.l0_h = per_km->l0_mh_per_km    ? *per_km->l0_mh_per_km * 1e-3 * km
                 : per_km->x0_ohm_per_km ? *per_km->x0_ohm_per_km / omega * km
                                         : t.l_h;
        t.c0_f = per_km->c0_nf_per_km ? *per_km->c0_nf_per_km * 1e-9 * km : t.c_f;
        return t;
    }
    t.r_ohm = r_ohm.value_or(0);
    t.l_h = l_mh ? *l_mh * 1e-3 : x_ohm.value_or(0) / omega;
    t.c_f = c_nf.value_or(0) * 1e-9;
    t.r0_ohm = r0_ohm.value_or(t.r_ohm);
    t.l0_h = l0_mh ? *l0_mh * 1e-3 : x0_ohm ? *x0_ohm / omega : t.l_h;
    t.c0_f = c0_nf ? *c0_nf * 1e-9 : t.c_f;
    return t;
}

} // namespace gridspace::sim

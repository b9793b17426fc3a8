// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/element_config.hpp"

#include "common/text.hpp"
#include "sim/network/profile_csv.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim::elements {
namespace {

void governor(Fields& f, Governor& g) {
    f.number("droop_percent", g.droop_percent, positive("frequency drop at full power"));
    f.number("tg_s", g.tg_s, not_negative("servo time constant"));
    f.number("tt_s", g.tt_s, not_negative("turbine time constant"));
    f.number("integral_ki", g.integral_ki, not_negative("integral gain; 0: droop only"));
}

} // namespace

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
    if (g.q_min_kvar && g.q_max_kvar && *g.q_min_kvar > *g.q_max_kvar) {
        f.error("q_min_kvar", fmt::format("generator '{}' has a least reactive power above its most", g.name.name),
                "q_min_kvar is negative where it takes reactive power");
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
    f.file("csv", csv, {.doc = "file with a column hours (or h, time_h) and others, instead of points"});
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

} // namespace gridspace::sim::elements

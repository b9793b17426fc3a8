// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/machine/regulator_fields.hpp"

#include "common/text.hpp"
#include "sim/components/machine/dead_time.hpp"
#include "sim/components/machine/saturation.hpp"

#include <fmt/format.h>
#include <initializer_list>
#include <string_view>
#include <tuple>

namespace gridspace::sim {

using namespace elements;

namespace {

/// An error for each key that is there and belongs to another type.
void refuse_keys(Fields& f, std::initializer_list<std::string_view> keys, std::string_view type) {
    for (std::string_view const key : keys) {
        if (f.has(key)) {
            f.error(key, fmt::format("`{}` is a key of `type: {}`", key, type), "leave it out, or change the type");
        }
    }
}

void read_ac8b(Fields& f, Ac8b& a, bool is) {
    f.number("kpr", a.kpr, not_negative("ac8b: proportional gain"));
    f.number("kir", a.kir, not_negative("ac8b: integral gain"));
    f.number("kdr", a.kdr, not_negative("ac8b: derivative gain"));
    f.number("tdr_s", a.tdr_s, not_negative("ac8b: lag of the derivative"));
    f.number("pid_min_pu", a.pid_min_pu, any("ac8b: lowest output of the control (VPIDMIN); without: any"));
    f.number("pid_max_pu", a.pid_max_pu, any("ac8b: highest output of the control (VPIDMAX); without: any"));
    f.number("vr_min_pu", a.vr_min_pu, any("ac8b: lowest output of the amplifier"));
    f.number("vr_max_pu", a.vr_max_pu, any("ac8b: highest output of the amplifier", is));
    f.number("te_s", a.te_s, positive("ac8b: time constant of the alternator", is));
    f.number("ke", a.ke, positive("ac8b: what its field needs for 1 p.u. without saturation"));
    f.number("kc", a.kc, not_negative("ac8b: loading of its rectifier"));
    f.number("kd", a.kd, not_negative("ac8b: demagnetizing by the field current"));
    f.number("e1_pu", a.e1_pu, not_negative("ac8b: voltage of the alternator at which its saturation is se_e1"));
    f.number("se_e1", a.se_e1, not_negative("ac8b: saturation there, quadratic"));
    f.number("e2_pu", a.e2_pu, not_negative("ac8b: voltage of the alternator at which its saturation is se_e2"));
    f.number("se_e2", a.se_e2, not_negative("ac8b: saturation there"));
    f.number("ve_min_pu", a.ve_min_pu, not_negative("ac8b: lowest voltage of the alternator"));
    f.number("vfe_max_pu", a.vfe_max_pu, positive("ac8b: highest field current of the alternator; without: any"));
    if (!is) {
        return;
    }
    if (a.kpr == 0 && a.kir == 0) {
        f.error("kpr", "a control without kpr and kir holds no voltage", "give one of them, or both");
    }
    if (a.kdr > 0 && a.tdr_s == 0) {
        f.error("kdr", "a derivative needs a lag", "give `tdr_s` too");
    }
    if (a.lowest() >= a.highest()) {
        f.error("pid_max_pu", fmt::format("pid_max_pu = {} is not above pid_min_pu = {}", shortest(a.highest()),
                                          shortest(a.lowest())));
    }
    if (a.vr_min_pu >= a.vr_max_pu) {
        f.error("vr_max_pu", fmt::format("vr_max_pu = {} is not above vr_min_pu = {}", shortest(a.vr_max_pu),
                                         shortest(a.vr_min_pu)));
    }
    if ((a.se_e1 > 0 || a.se_e2 > 0) && !machines::Saturation::fits(a.e1_pu, a.se_e1, a.e2_pu, a.se_e2)) {
        f.error("se_e2",
                fmt::format("no saturation goes through {} at {} p.u. and {} at {} p.u.", shortest(a.se_e1),
                            shortest(a.e1_pu), shortest(a.se_e2), shortest(a.e2_pu)),
                "it is larger at the larger voltage, and grows faster than that");
    }
}

void read_degov(Fields& f, Degov& e, bool is) {
    f.number("t1_s", e.t1_s, not_negative("degov: T1 of the control box"));
    f.number("t2_s", e.t2_s, not_negative("degov: T2 of the control box"));
    f.number("t3_s", e.t3_s, not_negative("degov: lead of the control box"));
    f.number("k", e.k, positive("degov: gain of the actuator", is));
    f.number("t4_s", e.t4_s, not_negative("degov: lead of the actuator"));
    f.number("t5_s", e.t5_s, not_negative("degov: first lag of the actuator"));
    f.number("t6_s", e.t6_s, not_negative("degov: second lag of the actuator"));
    f.number("td_s", e.td_s, not_negative("degov: dead time of the engine"));
    f.choice<DroopControl>("droop_control", e.droop_control,
                           {{"throttle", DroopControl::throttle}, {"electric_power", DroopControl::electric_power}},
                           {.doc = "degov: what its droop goes by (0 and 1 of DEGOV1)"});
    f.number("te_s", e.te_s, not_negative("degov: time constant of the measured electric power"));
    if (!is) {
        return;
    }
    if ((e.t1_s > 0) != (e.t2_s > 0)) {
        f.error(e.t1_s > 0 ? "t1_s" : "t2_s", "the control box needs t1_s and t2_s", "give both, or none of them");
    }
    if (e.t3_s > 0 && e.t1_s == 0) {
        f.error("t3_s", "a lead needs a lag", "give `t1_s` and `t2_s` too");
    }
    if (e.t4_s > 0 && e.t5_s == 0) {
        f.error("t4_s", "a lead needs a lag", "give `t5_s` too");
    }
    if (e.td_s > 0 && e.td_s < machines::DeadTime::kShortestS) {
        f.error("td_s", fmt::format("a dead time of {} s is shorter than 1 ms", shortest(e.td_s)), "leave it out");
    }
    if (f.has("te_s") && e.droop_control == DroopControl::throttle) {
        f.error("te_s", "nothing measures the electric power", "add `droop_control: electric_power`");
    }
}

void read_stabilizer(Fields& f, Stabilizer& s) {
    f.number("gain", s.gain, positive("voltage per p.u. of speed (KS)", true));
    f.number("washout_s", s.washout_s, positive("time constant of the washout (T5)"));
    f.number("t1_s", s.t1_s, not_negative("lead time constant of the first lead-lag"));
    f.number("t2_s", s.t2_s, not_negative("its lag time constant; 0: it is not there"));
    f.number("t3_s", s.t3_s, not_negative("lead time constant of the second lead-lag"));
    f.number("t4_s", s.t4_s, not_negative("its lag time constant; 0: it is not there"));
    f.number("min_pu", s.min_pu, {.doc = "lowest output", .max = 0});
    f.number("max_pu", s.max_pu, {.doc = "highest output", .min = 0});
    for (auto const& [key, lead, lag] : {std::tuple{"t1_s", s.t1_s, s.t2_s}, {"t3_s", s.t3_s, s.t4_s}}) {
        if (lead > 0 && lag == 0) {
            f.error(key, "a lead needs a lag", fmt::format("give `{}` too", key[1] == '1' ? "t2_s" : "t4_s"));
        }
    }
}

} // namespace

void read_regulator(Fields& f, Avr& r) {
    bool alternator = false;
    f.choice<bool>("type", alternator, {{"st1a", false}, {"ac8b", true}},
                   {.doc = "static exciter, or PID control of an alternator with diodes (IEEE 421.5)"});
    f.number("ka", r.ka, positive("gain", true));
    f.number("ta_s", r.ta_s, not_negative("time constant"));
    f.number("tr_s", r.tr_s, not_negative("measuring time constant"));
    f.number("efd_min_pu", r.efd_min_pu, any("lower limit of the field voltage"));
    f.number("efd_max_pu", r.efd_max_pu, any("upper limit of the field voltage", !alternator));
    f.number("tc_s", r.tc_s, not_negative("lead time constant before the gain"));
    f.number("tb_s", r.tb_s, not_negative("lag time constant before the gain; 0: there is no lead-lag"));
    f.number("kf", r.kf, not_negative("gain of the rate feedback from the field voltage"));
    f.number("tf_s", r.tf_s, positive("time constant of the rate feedback"));
    f.object("ceiling", {.doc = "limits that go with the terminal voltage: an exciter fed from there (ST1A)"},
             [&](Fields& c) {
                 FieldCeiling& ceiling = r.ceiling.emplace();
                 c.number("max_pu", ceiling.max_pu, positive("at nominal voltage and no field current (VRMAX)", true));
                 c.number("min_pu", ceiling.min_pu, any("at nominal voltage (VRMIN)"));
                 c.number("kc_pu", ceiling.kc_pu,
                          not_negative("what the upper one loses per p.u. of field current (KC)"));
                 if (ceiling.min_pu >= ceiling.max_pu) {
                     c.error("min_pu", fmt::format("min_pu = {} is not below max_pu = {}", shortest(ceiling.min_pu),
                                                   shortest(ceiling.max_pu)));
                 }
             });
    f.object("stabilizer", {.doc = "power system stabilizer by the speed (PSS1A)"},
             [&](Fields& s) { read_stabilizer(s, r.stabilizer.emplace()); });
    Ac8b a;
    read_ac8b(f, a, alternator);
    if (alternator) {
        r.ac8b = a;
        refuse_keys(f, {"efd_min_pu", "efd_max_pu", "tc_s", "tb_s", "kf", "tf_s", "ceiling"}, "st1a");
    } else {
        refuse_keys(f,
                    {"kpr", "kir", "kdr", "tdr_s", "pid_min_pu", "pid_max_pu", "vr_min_pu", "vr_max_pu", "te_s", "ke",
                     "kc", "kd", "e1_pu", "se_e1", "e2_pu", "se_e2", "ve_min_pu", "vfe_max_pu"},
                    "ac8b");
    }
    if (r.tc_s > 0 && r.tb_s == 0) {
        f.error("tc_s", "a lead needs a lag", "give `tb_s` too");
    }
    if (r.kf > 0 && r.ta_s == 0) {
        f.error("kf", "the rate feedback of a regulator without time constant would be a loop at one instant",
                "give `ta_s` too");
    }
}

void read_governor(Fields& f, Governor& g) {
    bool diesel = false;
    f.choice<bool>("type", diesel, {{"tgov1", false}, {"degov", true}},
                   {.doc = "turbine (TGOV1, with a load limit GAST), or diesel engine (DEGOV, with a droop DEGOV1)"});
    g.droop_percent = diesel ? 0 : g.droop_percent;
    f.number("droop_percent", g.droop_percent, positive("frequency drop at full power; degov: none without it"));
    f.number("tg_s", g.tg_s, not_negative("servo time constant"));
    f.number("tt_s", g.tt_s, not_negative("turbine time constant"));
    f.number("integral_ki", g.integral_ki, not_negative("integral gain; 0: droop only"));
    f.number("gate_min_pu", g.gate_min_pu, any("lowest position of the servo, or throttle (TMIN)"));
    f.number("gate_max_pu", g.gate_max_pu, any("highest position of the servo, or throttle (TMAX)"));
    f.number("lead_s", g.lead_s, not_negative("lead time constant of the turbine (T2 of TGOV1)"));
    f.number("damping_pu", g.damping_pu, not_negative("power that the turbine loses per p.u. of speed"));
    f.object("load_limit", {.doc = "a gas turbine's, by the temperature of its exhaust (GAST)"}, [&](Fields& l) {
        TurbineLoadLimit& limit = g.load_limit.emplace();
        l.number("power_pu", limit.power_pu, positive("power that it can give for long (AT)"));
        l.number("gain", limit.gain, not_negative("how hard it comes back to that (KT)"));
        l.number("t_s", limit.t_s, positive("time constant of the temperature (T3)"));
    });
    Degov engine;
    read_degov(f, engine, diesel);
    if (diesel) {
        g.degov = engine;
        refuse_keys(f, {"tg_s", "tt_s", "integral_ki", "lead_s", "damping_pu", "load_limit"}, "tgov1");
    } else {
        refuse_keys(f, {"t1_s", "t2_s", "t3_s", "k", "t4_s", "t5_s", "t6_s", "td_s", "droop_control", "te_s"}, "degov");
    }
    if (g.lowest() >= g.highest()) {
        f.error(
            "gate_max_pu",
            fmt::format("gate_max_pu = {} is not above gate_min_pu = {}", shortest(g.highest()), shortest(g.lowest())),
            "a servo moves between the two");
    }
    if (g.lead_s > 0 && g.tt_s == 0) {
        f.error("lead_s", "a lead needs the lag that it leads", "give `tt_s` too");
    }
}

} // namespace gridspace::sim

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/machine/machine.hpp"

#include "common/text.hpp"
#include "sim/components/machine/machine_data.hpp"

#include <fmt/format.h>
#include <tuple>

namespace gridspace::sim {

using namespace elements;

namespace {

constexpr Refusal kNoGovernor{"this machine has no governor", "give it or its type a `governor`"};

void read_governor(Fields& f, Governor& g) {
    f.number("droop_percent", g.droop_percent, positive("frequency drop at full power"));
    f.number("tg_s", g.tg_s, not_negative("servo time constant"));
    f.number("tt_s", g.tt_s, not_negative("turbine time constant"));
    f.number("integral_ki", g.integral_ki, not_negative("integral gain; 0: droop only"));
    f.number("gate_min_pu", g.gate_min_pu, any("lowest position of the servo"));
    f.number("gate_max_pu", g.gate_max_pu, any("highest position of the servo"));
    f.number("lead_s", g.lead_s, not_negative("lead time constant of the turbine (T2 of TGOV1)"));
    f.number("damping_pu", g.damping_pu, not_negative("power that the turbine loses per p.u. of speed"));
    f.object("load_limit", {.doc = "a gas turbine's, by the temperature of its exhaust (GAST)"}, [&](Fields& l) {
        TurbineLoadLimit& limit = g.load_limit.emplace();
        l.number("power_pu", limit.power_pu, positive("power that it can give for long (AT)"));
        l.number("gain", limit.gain, not_negative("how hard it comes back to that (KT)"));
        l.number("t_s", limit.t_s, positive("time constant of the temperature (T3)"));
    });
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

void read_regulator(Fields& f, Avr& r) {
    f.number("ka", r.ka, positive("gain", true));
    f.number("ta_s", r.ta_s, not_negative("time constant"));
    f.number("tr_s", r.tr_s, not_negative("measuring time constant"));
    f.number("efd_min_pu", r.efd_min_pu, any("lower limit of the field voltage"));
    f.number("efd_max_pu", r.efd_max_pu, any("upper limit of the field voltage", true));
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
    if (r.tc_s > 0 && r.tb_s == 0) {
        f.error("tc_s", "a lead needs a lag", "give `tb_s` too");
    }
    if (r.kf > 0 && r.ta_s == 0) {
        f.error("kf", "the rate feedback of a regulator without time constant would be a loop at one instant",
                "give `ta_s` too");
    }
}

void read_constants(Fields& c, MachineType& t, bool full) {
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
}

} // namespace

void MachineType::fields(Fields& f) {
    f.choice<MachineModel>("model", model, {{"full", MachineModel::full}, {"classical", MachineModel::classical}},
                           {.doc = "rotor circuits, or constant voltage behind xd1"});
    bool const full = model == MachineModel::full;
    f.object("constants_pu", {.doc = "reactances and resistance on the machine's rating", .required = true},
             [&](Fields& c) { read_constants(c, *this, full); });
    f.object("times_s", {.doc = "open-circuit time constants", .required = full}, [&](Fields& c) {
        c.number("td01", td01_s, positive("transient, d", full));
        c.number("td02", td02_s, positive("subtransient, d", full));
        c.number("tq02", tq02_s, positive("subtransient, q", full));
    });
    f.number("inertia_h_s", inertia_h_s, positive("inertia constant", true));
    f.number("damping_pu", damping_pu, not_negative("damping torque per p.u. speed"));
    f.object("avr", {.doc = "voltage regulator and exciter"}, [&](Fields& a) { read_regulator(a, avr.emplace()); });
    f.object("governor", {.doc = "speed governor and turbine"},
             [&](Fields& g) { read_governor(g, governor.emplace()); });
}

void Machine::fields(Fields& f) {
    f.reference("type", type, {.doc = "machine type", .required = true});
    f.number("rating_kva", rating_kva, positive("rated power", true));
    f.number("p_kw", p_kw, any("power at the start", true));
    f.number("voltage_setpoint_pu", voltage_setpoint_pu, positive("terminal voltage at the start"));
    f.number("inertia_h_s", inertia_h_s, positive("overrides the type's"));
    f.object("governor", {.doc = "overrides the type's"}, [&](Fields& g) { read_governor(g, governor.emplace()); });
}

Complex Machine::sequence_pu(Sequence sequence, Surroundings const& around) const {
    machines::MachineData const d = machines::machine_data(*this, around);
    if (sequence == Sequence::zero && d.x0 <= 0) {
        return {};
    }
    return rating_kva / around.base_kva() / Complex{d.ra, sequence == Sequence::zero ? d.x0 : d.x2()};
}

bool Machine::earthed(Surroundings const& around) const {
    MachineType const* found = around.find<MachineType>(type);
    return found != nullptr && found->pu.x0 > 0;
}

Governor const* Machine::governor_of(Surroundings const& around) const {
    MachineType const* found = around.find<MachineType>(type);
    return governor ? &*governor : found != nullptr && found->governor ? &*found->governor : nullptr;
}

bool Machine::set(std::string_view quantity, double value) {
    if (quantity == "p_kw") {
        p_kw = value;
    } else if (quantity == "voltage_setpoint_pu") {
        voltage_setpoint_pu = value;
    }
    return true;
}

std::optional<Refusal> Machine::refuses(std::string_view quantity, Surroundings const& around, bool) const {
    bool const of_governor = quantity == "droop_percent" || quantity == "frequency_setpoint_hz";
    return of_governor && governor_of(around) == nullptr ? std::optional{kNoGovernor} : std::nullopt;
}

std::optional<Refusal> Machine::refuses_mode(std::string_view mode, Surroundings const& around) const {
    Governor const* found = governor_of(around);
    if (found == nullptr) {
        return kNoGovernor;
    }
    return mode == "isochronous" && found->integral_ki == 0
               ? std::optional{Refusal{"its governor has no integral", "give it an `integral_ki`"}}
               : std::nullopt;
}

double Machine::value(std::string_view quantity, Surroundings const& around) const {
    Governor const* found = governor_of(around);
    return quantity == "p_kw"                  ? p_kw
           : quantity == "voltage_setpoint_pu" ? voltage_setpoint_pu
           : found == nullptr                  ? 0
           : quantity == "droop_percent"       ? found->droop_percent
                                               : around.frequency_hz();
}

} // namespace gridspace::sim

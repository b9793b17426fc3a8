// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/machine/machine.hpp"

#include "common/text.hpp"
#include "sim/components/machine/machine_data.hpp"
#include "sim/components/machine/regulator_fields.hpp"

#include <fmt/format.h>

namespace gridspace::sim {

using namespace elements;

namespace {

constexpr Refusal kNoGovernor{"this machine has no governor", "give it or its type a `governor`"};
constexpr Refusal kNoDroop{"its governor holds the speed, whatever power that takes", "give it a `droop_percent`"};

/// DEGOV without a droop.
bool holds_speed_only(Governor const* g) {
    return g != nullptr && g->degov && g->droop_percent == 0;
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

void read_saturation(Fields& f, OpenCircuitSaturation& s) {
    f.number("s10", s.s10, not_negative("what the field needs more than on the air-gap line at nominal voltage", true));
    f.number("s12", s.s12, not_negative("the same at 1.2 times nominal voltage", true));
    if (!machines::Saturation::fits(1, s.s10, 1.2, s.s12)) {
        f.error("s12", fmt::format("s12 = {} is less than 1.2 times s10 = {}", shortest(s.s12), shortest(s.s10)),
                "saturation grows faster than the voltage");
    }
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
    f.object("saturation", {.doc = "of the open-circuit curve, acting on the field (E'q), as in GENSAL"},
             [&](Fields& s) { read_saturation(s, saturation.emplace()); });
    if (saturation && !full) {
        f.error("saturation", fmt::format("'{}' is classical: it has no field winding", name.name), "leave it out");
    }
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
    Governor const* found = governor_of(around);
    bool const of_droop = quantity == "droop_percent";
    if (found == nullptr && (of_droop || quantity == "frequency_setpoint_hz")) {
        return kNoGovernor;
    }
    return (of_droop || quantity == "p_kw") && holds_speed_only(found) ? std::optional{kNoDroop} : std::nullopt;
}

std::optional<Refusal> Machine::refuses_mode(std::string_view mode, Surroundings const& around) const {
    Governor const* found = governor_of(around);
    if (found == nullptr) {
        return kNoGovernor;
    }
    if (found->degov) {
        return mode != "isochronous" && holds_speed_only(found) ? std::optional{kNoDroop} : std::nullopt;
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

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/ev/ev_config.hpp"

namespace gridspace::agents {
namespace {

void agent(config::Fields& f, EvConfig::Agent& a) {
    using TimeBase = EvParams::TimeBase;
    f.text("bus", a.bus, {.doc = "bus of the EV; from the network when not given"});
    f.number("capacity_kwh", a.params.capacity_kwh,
             {.doc = "energy of the battery; from the network when not given", .above = 0});
    f.number("battery_v", a.params.battery_v, {.doc = "voltage V_b of Eq. (1)", .above = 0});
    f.number("rated_current_a", a.params.rated_current_a, {.doc = "cap of Eq. (2)", .above = 0});
    f.number("soc_target_percent", a.params.soc_target_percent,
             {.doc = "wanted state of charge", .min = 0, .max = 100});
    f.number("requested_h", a.params.requested_h,
             {.doc = "time after the start in which it shall be reached", .above = 0});
    f.choice<TimeBase>("time_base", a.params.time_base,
                       {{"remaining", TimeBase::remaining}, {"fixed", TimeBase::fixed}},
                       {.doc = "t of Eq. (1): what is left of requested_h, or requested_h as printed"});
    f.number("min_remaining_h", a.params.min_remaining_h, {.doc = "least t of Eq. (1)", .above = 0});
}

} // namespace

void describe(config::Fields& f, EvConfig& config) {
    f.fraction("period_s", config.period_s, {.doc = "time between two requests", .above = 0});
    f.fraction("latency_us", config.latency_us, {.doc = "from measurement to request, in lockstep", .min = 0});
    EvConfig::Agent shared;
    f.reference("ev", shared.ev, {.doc = "the EV that it acts for"});
    agent(f, shared);
    if (!shared.ev.empty()) {
        config.agents.push_back(shared);
    }
    f.map("evs", {.doc = "several EVs in one process; each may override the keys beside it"},
          [&](config::Ref const& name, config::Fields& one) {
              EvConfig::Agent own = shared;
              own.ev = name;
              agent(one, own);
              config.agents.push_back(own);
          });
    if (config.agents.empty()) {
        f.error("", "an EV agent needs an EV", "`ev: NAME`, or `evs: {NAME: {...}}` for several in one process");
    }
}

program::Declaration ev_declaration() {
    std::vector<program::ElementUse::Default> const from_network{{"bus", "bus"}, {"capacity_kwh", "capacity_kwh"}};
    return {.name = "gridspace-ev",
            .description = "EV agent: asks for the charging current that its EV needs",
            .role = "ev_agent",
            .settings = config::keys_of<EvConfig>(),
            .whole_steps = {"period_s"},
            .latency = "latency_us",
            .elements = {{"ev", "ev", "acts for", from_network}, {"evs", "ev", "acts for", from_network}},
            .reads = {{.topic = "bus_measurements", .type = "BusMeasurement"}},
            .writes = {{.topic = "requests", .type = "ChargingRequest"}},
            .signals = {{"agent.{process}[.{ev|evs}].requested_a", "A"}, {"agent.{process}[.{ev|evs}].v_pu", "p.u."}}};
}

} // namespace gridspace::agents

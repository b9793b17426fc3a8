// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/mcca/mcca_config.hpp"

namespace gridspace::agents {

void describe(config::Fields& f, MccaConfig& config) {
    using Overlap = MccaRules::Overlap;
    f.references("evs", config.evs, {.doc = "it decides when all of these have asked", .required = true});
    f.fraction("request_timeout_s", config.request_timeout_s,
               {.doc = "after the first request, it decides with those that did", .above = 0});
    f.fraction("latency_us", config.latency_us,
               {.doc = "from the last request to the effect of the decision, in lockstep", .min = 0});
    f.object("rules", {.doc = "Eq. (3) and (4)"}, [&](config::Fields& r) {
        MccaRules& rules = config.rules;
        r.number("full_above_pu", rules.full_above_pu,
                 {.doc = "all get what they asked for while every voltage is above", .above = 0});
        r.number("full_again_above_pu", rules.full_again_above_pu,
                 {.doc = "the other side of the published overlap", .above = 0});
        r.number("stop_at_pu", rules.stop_at_pu, {.doc = "at or below: undervoltage", .above = 0});
        r.number("curtail_factor", rules.curtail_factor, {.doc = "factor of Eq. (3)", .min = 0, .max = 1});
        r.number("undervoltage_factor", rules.undervoltage_factor,
                 {.doc = "factor of Eq. (4) at healthy buses", .min = 0, .max = 1});
        r.choice<Overlap>(
            "overlap", rules.overlap,
            {{"first_match", Overlap::first_match}, {"safe", Overlap::safe}, {"hysteresis", Overlap::hysteresis}},
            {.doc = "how the published overlap 0.97 to 0.975 is read"});
        if (rules.stop_at_pu > rules.full_above_pu) {
            r.error("stop_at_pu", "it lies above full_above_pu");
        }
        if (rules.full_again_above_pu < rules.full_above_pu) {
            r.error("full_again_above_pu", "it lies below full_above_pu");
        }
    });
}

program::Declaration mcca_declaration() {
    return {.name = "gridspace-mcca",
            .description = "microgrid control agent: decides on the charging of all EVs",
            .role = "mcca",
            .settings = config::keys_of<MccaConfig>(),
            .latency = "latency_us",
            .elements = {{"evs", "ev", "decides for"}},
            .reads = {{.topic = "requests", .type = "ChargingRequest", .triggers = true}},
            .writes = {{.topic = "decisions", .type = "ChargingDecision"}},
            .signals = {{"agent.{process}.curtailed"}, {"agent.{process}.undervoltage"}, {"agent.{process}.complete"}}};
}

} // namespace gridspace::agents

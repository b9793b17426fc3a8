// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/attacker_config.hpp"

namespace gridspace::attacker {

void describe(config::Fields& f, AttackerConfig& config) {
    f.text("labels", config.labels, {.doc = "DDS topic for the ground truth of each altered sample; left out: none"});
    f.fraction("latency_us", config.latency_us,
               {.doc = "lockstep, second publisher: from a frame heard to a forged one", .min = 0});
}

void describe(config::Fields& f, AttackerSettings& settings) {
    describe(f, settings.config);
    describe_attacks(f, settings.attacks);
    f.integer("seed", settings.seed, {.doc = "of everything random"});
    f.number("frequency_hz", settings.frequency_hz, {.doc = "nominal frequency", .above = 0});
    f.references("towards_host", settings.towards_host, {.doc = "attacks in a cable whose target goes to the host"});
    f.map("topic_types", {.doc = "types of the topics that are attacked"},
          [&](config::Ref const& topic, config::Fields& t) {
              t.text("type", settings.topic_types[topic.name],
                     {.doc = "LineCurrents or TripCommand", .required = true});
          });
    f.text("allow_attacks_on", settings.allow_attacks_on, {.doc = "an interface that is not a virtual cable"});
}

} // namespace gridspace::attacker

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/attack_config.hpp"

#include <map>
#include <string>

namespace gridspace::attacker {

/// gridspace-attacker, as a scenario says it. What it does stands in the scenario's `attacks:`.
struct AttackerConfig {
    std::string labels;      ///< topic; empty: none
    Rational latency_us{20}; ///< lockstep, second publisher: from a frame heard to a forged one
};
void describe(config::Fields& f, AttackerConfig& config);

/// What the launcher adds: the attacks of this process, and what it has to know about the rest of the scenario.
struct AttackerSettings {
    AttackerConfig config;
    std::vector<AttackConfig> attacks;
    std::int64_t seed{0};
    double frequency_hz{60};
    std::vector<config::Ref> towards_host; ///< attacks in a cable whose target goes to the host; others: comes from it
    std::map<std::string, std::string> topic_types; ///< of the topics that are attacked
    std::string allow_attacks_on;                   ///< an interface that is not a virtual cable
};
void describe(config::Fields& f, AttackerSettings& settings);

} // namespace gridspace::attacker

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/attacker_config.hpp"
#include "common/program/declaration.hpp"

namespace gridspace::attacker {

/// How many frames or samples of an attack have been forged.
[[nodiscard]] program::Signal forged_signal(AttackConfig const& attack);

/// What an attacker does that is in charge of these attacks. `type_of`: of a topic that is attacked; empty: unknown.
[[nodiscard]] program::Declaration declaration(AttackerConfig const& config,
                                               std::vector<AttackConfig const*> const& attacks,
                                               std::function<std::string(std::string const& topic)> const& type_of);
/// Without attacks, and with names of settings in the place of their values.
[[nodiscard]] program::Declaration attacker_declaration();

} // namespace gridspace::attacker

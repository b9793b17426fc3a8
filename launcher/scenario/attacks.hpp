// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scenario/scenario.hpp"

#include <string>
#include <vector>

namespace gridspace::launcher {

/// `place: second_publisher` is short for `place: {second_publisher: true}`.
void spell_out_places(config::Node& root);

/// What the attacks refer to must be there and be of the right kind. A place that is named by a process becomes its
/// host.
void check_attacks(Scenario& scenario, config::Diagnostics& diagnostics);

/// The attacks of a process.
[[nodiscard]] std::vector<attacker::AttackConfig const*> attacks_of(Scenario const& scenario, Process const& process);

/// The type of an attacked topic: LineCurrents or TripCommand, or empty.
[[nodiscard]] std::string attacked_type(Scenario const& scenario, std::string const& topic);

/// Does a process of this host send (or receive) the stream on the link?
[[nodiscard]] bool stream_passes(Scenario const& scenario, std::string const& stream, std::string const& host,
                                 std::string const& link, bool sent);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"
#include "launcher/scenario/scenario.hpp"

#include <string>

namespace gridspace::launcher {

/// Makes of each entry of `impairments:` what it stands for: a process of gridspace-link on a host of its own, both
/// with the name of the entry. The section is gone afterwards.
void expand_impairments(config::Node& root, config::Diagnostics& diagnostics);

/// `set: {impairments.NAME.KEY: value}` of the events must lead to something.
void check_impairment_events(Scenario const& scenario, config::Diagnostics& diagnostics);

/// What the events set for a process, in their order, as its setting `changes:`.
[[nodiscard]] config::Node impairment_changes(Scenario const& scenario, std::string const& process);

} // namespace gridspace::launcher

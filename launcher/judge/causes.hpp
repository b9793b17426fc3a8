// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"
#include "launcher/judge/protection_chain.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

namespace gridspace::launcher {

/// An event of the timeline and when it was, seconds.
using Cause = std::pair<std::string, double>;

/// The last event of the timeline before `until_s`; a fault rather than anything else.
[[nodiscard]] std::optional<Cause> cause_before(config::Node const& scenario, double until_s);
/// The newest fault at `until_s` on one of the lines at whose ends the relay's current transformers are, by the run's
/// copy of the network file. One that cleared itself long before is no cause of a trip.
[[nodiscard]] std::optional<Cause> fault_on_own_line(std::filesystem::path const& run, config::Node const& scenario,
                                                     ProtectionChain const& chain, double until_s);

} // namespace gridspace::launcher

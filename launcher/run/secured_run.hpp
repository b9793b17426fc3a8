// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "launcher/run/run_plan.hpp"
#include "launcher/scenario/scenario.hpp"

namespace gridspace::launcher {

/// `security:` of the scenario: writes RUN/security (the rules of the bus, for each process its rights and its QoS
/// profiles with the names of its keys, and the keys where they are for this run alone) and informs the processes of
/// the plan. Does nothing without it. Fails, before anything starts, with the name of an identity that is not there,
/// has expired, is revoked or lies open.
[[nodiscard]] Result<void> secure(Scenario const& scenario, RunPlan& plan, std::vector<int> const& domains,
                                  std::int64_t now_unix_s);

/// After the run: keys that were made for it alone are of no more use to anybody.
void forget_run_keys(std::filesystem::path const& run);

} // namespace gridspace::launcher

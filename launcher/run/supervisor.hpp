// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/unique_fd.hpp"
#include "launcher/run/run_plan.hpp"

#include <map>
#include <string>

namespace gridspace::launcher {

/// Carries out a plan: builds the network, starts the processes, watches them, ends them. Runs as process 1 of the
/// run's namespaces (or as an ordinary process without them), so that nothing outlives it. Talks to the launcher over
/// `channel`: JSON lines out (what happens), the word "stop" in. Returns the exit code of the run.
int supervise(RunPlan const& plan, int channel, std::map<std::string, UniqueFd> const& listen_fds);

} // namespace gridspace::launcher

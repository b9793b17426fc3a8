// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"

#include <string>

namespace gridspace::launcher {

struct Scenario;

/// The settings of gridspace-monitor about the run: its `run:` settings (monitor/app/run_plan.hpp).
/// `folder`: the run folder as seen from the file that the settings go to.
[[nodiscard]] config::Node monitored_run(Scenario const& scenario, std::string const& folder);

/// The configuration of a gridspace-monitor that shows the run when it is over (`gridspace monitor RUN`).
[[nodiscard]] config::Node recorded_monitor(Scenario const& scenario);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"

namespace gridspace::launcher {

struct Scenario;

/// What gridspace-monitor is told about the run: its `run:` settings (monitor/app/run_plan.hpp).
[[nodiscard]] config::Node monitored_run(Scenario const& scenario);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/daemon.hpp"
#include "sim/app/sim_config.hpp"

namespace gridspace::sim {

/// Reads the network and checks events against it.
void check(SimConfig const& config, config::Diagnostics& diagnostics);

/// Runs the whole simulation on the bus.
[[nodiscard]] Result<void> run(SimConfig const& config, DaemonRun& run);

} // namespace gridspace::sim

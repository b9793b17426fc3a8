// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/program/declaration.hpp"
#include "sim/app/sim_config.hpp"

namespace gridspace::sim {

/// What the simulator of this simulation reads, writes and publishes. Sections that cannot be read give nothing: where
/// they are checked, it is said. `network`: null when it cannot be read.
[[nodiscard]] program::Declaration declaration(SimulationConfig const& simulation, Network const* network);
/// Without a simulation: its settings.
[[nodiscard]] program::Declaration sim_declaration();

} // namespace gridspace::sim

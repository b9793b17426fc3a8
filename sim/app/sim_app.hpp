// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/daemon.hpp"
#include "sim/app/sim_config.hpp"
#include "sim/engine/engine.hpp"
#include "sim/network/network.hpp"

namespace gridspace::sim {

/// The network of a simulation with its changes applied; what is wrong with it is in `diagnostics`.
[[nodiscard]] std::optional<Network> load_simulated_network(SimulationConfig const& simulation,
                                                            config::Diagnostics& diagnostics);

/// The engine for a simulation.
[[nodiscard]] Result<std::unique_ptr<Engine>> make_engine(SimulationConfig const& simulation, Network network, TimeBase base);

/// Reads the network and checks events against it.
void check(SimConfig const& config, config::Diagnostics& diagnostics);

/// Runs the whole simulation on the bus.
[[nodiscard]] Result<void> run(SimConfig const& config, DaemonRun& run);

} // namespace gridspace::sim

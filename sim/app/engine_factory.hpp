// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/app/sim_config.hpp"
#include "sim/engine/engine.hpp"
#include "sim/network/network.hpp"

#include <memory>
#include <optional>

namespace gridspace::sim {

/// The network of a simulation with its changes applied; what is wrong with it is in `diagnostics`.
[[nodiscard]] std::optional<Network> load_simulated_network(SimulationConfig const& simulation,
                                                            config::Diagnostics& diagnostics);

/// The engine for a simulation.
[[nodiscard]] Result<std::unique_ptr<Engine>> make_engine(SimulationConfig const& simulation, Network network,
                                                          TimeBase base);

/// The signals that it will have, without solving anything; none when it cannot be made.
[[nodiscard]] std::vector<SignalDef> engine_signals(SimulationConfig const& simulation, Network const& network);

/// UTC hour of the day of simulated time 0.
[[nodiscard]] double start_hour_of_day(SimulationConfig const& simulation);

} // namespace gridspace::sim

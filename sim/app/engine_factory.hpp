// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/app/sim_config.hpp"
#include "sim/solvers/make_engine.hpp"
#include "sim/solvers/step.hpp"

#include <optional>

namespace gridspace::sim {

/// The network of a simulation with its changes applied; what is wrong with it is in `diagnostics`.
[[nodiscard]] std::optional<Network> load_simulated_network(SimulationConfig const& simulation,
                                                            config::Diagnostics& diagnostics);

/// Gives `step_s: auto` its value: a whole part of the period of samples (1/4800 s without), the tick and the duration.
void settle_step(SimulationConfig& simulation, Network const& network, std::optional<Rational> tick_s);
/// Why its waveforms would show an oscillation of the network wrongly; nothing when they do not.
[[nodiscard]] std::optional<StepWarning> step_warning(SimulationConfig const& simulation, Network const& network);

/// The signals that its engine will have, without solving anything; none when it cannot be made.
[[nodiscard]] std::vector<SignalDef> engine_signals(SimulationConfig const& simulation, Network const& network);

} // namespace gridspace::sim

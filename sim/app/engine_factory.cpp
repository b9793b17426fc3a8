// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/app/engine_factory.hpp"

#include "common/config/merge.hpp"
#include "sim/network/network_config.hpp"

namespace gridspace::sim {

std::optional<Network> load_simulated_network(SimulationConfig const& simulation, config::Diagnostics& diagnostics) {
    if (simulation.network_changes.is_null()) {
        return load_network(simulation.network, diagnostics, simulation.network_mark);
    }
    if (simulation.network.extension() == ".m") {
        diagnostics.error(simulation.network_changes.where, "network_changes cannot be laid over a MATPOWER case");
        return std::nullopt;
    }
    auto root = config::load_extended(simulation.network, diagnostics, simulation.network_mark);
    if (!root) {
        return std::nullopt;
    }
    config::merge(*root, simulation.network_changes);
    return read_network(*root, diagnostics);
}

std::vector<SignalDef> engine_signals(SimulationConfig const& simulation, Network const& network) {
    auto const engine = make_engine(simulation, network, TimeBase{simulation.step_s});
    return engine ? (*engine)->signals() : std::vector<SignalDef>{};
}

} // namespace gridspace::sim

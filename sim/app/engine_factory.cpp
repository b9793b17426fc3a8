// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/app/engine_factory.hpp"

#include "common/config/merge.hpp"
#include "sim/emt/emt_engine.hpp"
#include "sim/network/network_config.hpp"
#include "sim/phasor/phasor_engine.hpp"
#include "sim/runtime/fuse_engine.hpp"
#include "sim/runtime/tap_changing_engine.hpp"

namespace gridspace::sim {

double start_hour_of_day(SimulationConfig const& simulation) {
    std::int64_t const epoch = parse_utc(simulation.epoch).value_or(0);
    return static_cast<double>(((epoch % 86400) + 86400) % 86400) / 3600;
}

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

namespace {

Result<std::unique_ptr<Engine>> make_solver(SimulationConfig const& simulation, Network network, TimeBase base) {
    if (simulation.solver == SolverKind::emt) {
        return emt::make_emt_engine(std::move(network),
                                    {base, base.nearest(simulation.step_s), start_hour_of_day(simulation)});
    }
    phasor::PhasorOptions options{.time_base = base, .start_hour_of_day = start_hour_of_day(simulation)};
    options.fixed_step_s = simulation.fixed_step ? simulation.step_s.to_double() : 0;
    return phasor::make_phasor_engine(std::move(network), options);
}

} // namespace

Result<std::unique_ptr<Engine>> make_engine(SimulationConfig const& simulation, Network network, TimeBase base) {
    auto solver = make_solver(simulation, network, base);
    if (!solver) {
        return solver;
    }
    return with_fuses(with_tap_changers(std::move(*solver), network, base), network, base,
                      base.nearest(simulation.step_s));
}

std::vector<SignalDef> engine_signals(SimulationConfig const& simulation, Network const& network) {
    auto const engine = make_engine(simulation, network, TimeBase{simulation.step_s});
    return engine ? (*engine)->signals() : std::vector<SignalDef>{};
}

} // namespace gridspace::sim

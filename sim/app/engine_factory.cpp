// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/app/engine_factory.hpp"

#include "common/config/merge.hpp"
#include "sim/emt/step_choice.hpp"
#include "sim/gateway/gateway_config.hpp"
#include "sim/network/network_config.hpp"

#include <stdexcept>

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

namespace {

/// Steps are whole parts of it.
Rational sample_period(SimulationConfig const& simulation) {
    config::Diagnostics ignored; // reported where the sampling is used
    return simulation.sampling.is_null() ? kUsualSamplePeriod
                                         : Rational{1} / read_sampling(simulation.sampling, ignored).rate_hz;
}

/// Of which both are whole multiples. Without one of use `a` stays: that the other is no whole number of steps is then
/// said where times are checked.
Rational shared_period(Rational a, Rational b) {
    try {
        Rational const both = common_divisor(a, b);
        return both.to_double() < emt::kShortestAutoStep ? a : both;
    } catch (std::overflow_error const&) {
        return a;
    }
}

} // namespace

void settle_step(SimulationConfig& simulation, Network const& network, std::optional<Rational> tick_s) {
    Rational period = sample_period(simulation);
    for (Rational const other : {tick_s.value_or(Rational{0}), simulation.duration()}) {
        period = other > Rational{0} ? shared_period(period, other) : period;
    }
    settle_step(static_cast<EngineSettings&>(simulation), network, period);
}

std::optional<StepWarning> step_warning(SimulationConfig const& simulation, Network const& network) {
    return step_warning(simulation, network, sample_period(simulation));
}

std::vector<SignalDef> engine_signals(SimulationConfig const& simulation, Network const& network) {
    EngineSettings settings{static_cast<EngineSettings const&>(simulation)};
    settings.threads = 1; // nothing is stepped
    auto const engine = make_engine(settings, network, TimeBase{simulation.step_s});
    return engine ? (*engine)->signals() : std::vector<SignalDef>{};
}

} // namespace gridspace::sim

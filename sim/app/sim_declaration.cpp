// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/app/sim_declaration.hpp"

#include "sim/app/engine_factory.hpp"
#include "sim/controls/control_config.hpp"
#include "sim/gateway/gateway_config.hpp"

#include <algorithm>

namespace gridspace::sim {
namespace {

using program::Topic;

/// Measurements of buses and batteries, and decisions about EVs: a reader or writer for each.
void add_buses(Network const& network, program::Declaration& out) {
    auto const count = [](auto const& list) { return static_cast<std::int64_t>(list.size()); };
    out.writes.push_back({.topic = "bus_measurements", .type = "BusMeasurement", .endpoints = count(network.buses)});
    if (!network.batteries.empty()) {
        out.writes.push_back(
            {.topic = "battery_measurements", .type = "BatteryMeasurement", .endpoints = count(network.batteries)});
    }
    auto const with_evs = std::ranges::count_if(network.buses, [&](Bus const& bus) {
        return std::ranges::any_of(network.evs, [&](Ev const& ev) { return ev.bus == bus.name; });
    });
    if (with_evs > 0) {
        out.reads.push_back({.topic = "decisions", .type = "ChargingDecision", .endpoints = with_evs});
    }
}

/// What it may be steered by; a topic of its own for commands.
void add_controls(std::vector<ControlConfig> const& controls, std::vector<Topic>& reads) {
    auto const any = [&](bool commands) {
        return std::ranges::any_of(controls, [&](ControlConfig const& c) { return c.quantity.empty() == commands; });
    };
    if (any(false)) {
        reads.push_back({.topic = "set_points", .type = "SetPoint", .optional = true});
    }
    if (any(true)) {
        reads.push_back({.topic = "commands", .type = "ElementCommand", .optional = true});
    }
}

void add_lines(GatewaysConfig const& gateways, program::Declaration& out) {
    for (LineGatewayConfig const& gateway : gateways.lines) {
        for (auto const& publish : gateway.publish) {
            out.writes.push_back(
                {.topic = publish.topic.name, .type = publish.voltage.empty() ? "LineCurrents" : "BaySamples"});
        }
        for (auto const& subscribe : gateway.subscribe) {
            out.reads.push_back({.topic = subscribe.topic.name,
                                 .type = "TripCommand",
                                 .optional = true}); // a line may be without a relay
        }
    }
}

} // namespace

program::Declaration sim_declaration() {
    return {.name = "gridspace-sim",
            .description = "simulator: network, simulation clock and gateways",
            .role = "simulator",
            .member = false, // it is the clock
            .settings = config::keys_of<SimConfig>()};
}

program::Declaration declaration(SimulationConfig const& simulation, Network const* network) {
    program::Declaration out = sim_declaration();
    config::Diagnostics ignored;
    GatewaysConfig const gateways = read_gateways(simulation.gateways, ignored);
    if (gateways.per_bus && network != nullptr) {
        add_buses(*network, out);
    }
    add_controls(read_controls(simulation.controls, ignored), out.reads);
    add_lines(gateways, out);
    if (network != nullptr) {
        double const rate_hz = signal_rate_hz(simulation).to_double();
        for (SignalDef& signal : engine_signals(simulation, *network)) {
            double const own_rate_hz = is_switching_signal(signal.name) ? 0 : rate_hz;
            out.signals.push_back({std::move(signal.name), std::move(signal.unit), own_rate_hz});
        }
    }
    return out;
}

} // namespace gridspace::sim

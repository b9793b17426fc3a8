// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "common/rational.hpp"

#include <cstdint>
#include <vector>

namespace gridspace::sim {

using config::Ref;
struct Network;

/// `simulation.sampling`: instantaneous values for merging units.
struct SamplingConfig {
    Rational rate_hz{4800};
    std::int64_t samples_per_message{4};
};
void describe(config::Fields& f, SamplingConfig& sampling);

/// An entry of `simulation.gateways`: one DDS gateway of the simulator, usually one per line.
struct LineGatewayConfig {
    struct Publish {
        Ref topic, transformer; ///< a current transformer of the network
        Ref voltage;            ///< a voltage transformer as well; empty: currents alone
    };
    struct Subscribe {
        Ref topic;
        std::vector<Ref> breakers; ///< opened by a trip command
    };
    Ref name;
    std::vector<Publish> publish;
    std::vector<Subscribe> subscribe;
};

/// What `simulation.gateways` says.
struct GatewaysConfig {
    bool per_bus{false}; ///< gateways of each bus (bus_measurements out, decisions in) and battery
    std::vector<LineGatewayConfig> lines;
};

/// Reads both nodes (either may be null) and checks names against the network.
[[nodiscard]] GatewaysConfig read_gateways(config::Node const& gateways, config::Diagnostics& diagnostics);
[[nodiscard]] SamplingConfig read_sampling(config::Node const& sampling, config::Diagnostics& diagnostics);
void check_gateways(GatewaysConfig const& gateways, Network const& network, config::Diagnostics& diagnostics);

} // namespace gridspace::sim

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/yaml.hpp"
#include "sim/controls/controls.hpp"
#include "sim/network/network_config.hpp"

#include <gtest/gtest.h>

namespace gridspace::sim {

inline config::Node parse(std::string_view text) {
    config::Diagnostics diagnostics;
    auto const root = config::parse_yaml(text, config::make_source("c.yaml", text), diagnostics);
    EXPECT_TRUE(root.has_value()) << diagnostics.render();
    return *root;
}

inline Network grid() {
    config::Diagnostics diagnostics;
    auto network = read_network(parse(R"(gridspace_network: 1
name: t
base: {frequency_hz: 50, power_kva: 100}
buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}
lines: {L: {from: A, to: B, r_ohm: 0.05, l_mh: 0.1}}
breaker_types: {quick: {mechanism_ms: 0}}
breakers: {CB: {line: L, end: from, type: quick}}
generators: {G: {bus: A, role: slack}}
sources: {S: {bus: B, r_ohm: 0.01, l_mh: 0.1}}
machine_types: {unit: {model: classical, constants_pu: {xd1: 0.3, x0: 0.15}, inertia_h_s: 3.5, governor: {droop_percent: 5}}}
machines: {M: {bus: B, type: unit, rating_kva: 50, p_kw: 5}}
loads: {L1: {bus: B, p_kw: 10}, L2: {bus: B, p_kw: 5}, DC: {bus: B, p_kw: 1, model: dc_resistive}}
batteries: {BAT1: {bus: B, capacity_kwh: 20, rating_kva: 20, p_kw: 2}, BAT2: {bus: B, capacity_kwh: 20, rating_kva: 20}}
)"),
                                diagnostics);
    EXPECT_TRUE(network.has_value()) << diagnostics.render();
    return std::move(*network);
}

} // namespace gridspace::sim

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/yaml.hpp"
#include "common/source_tree.hpp"
#include "sim/emt/emt_engine.hpp"
#include "sim/network/network_config.hpp"

#include <gtest/gtest.h>
#include <memory>
#include <string>

/// What the tests of the waveform engine share: networks from files or text, and engines that have been started.
namespace gridspace::sim::emt {

inline Network shipped_network(std::string const& file) {
    config::Diagnostics diagnostics;
    auto network = load_network(source_tree("configs/networks/") + file, diagnostics, {});
    EXPECT_TRUE(network.has_value()) << diagnostics.render();
    return network.value_or(Network{});
}

inline Network network_of(std::string_view body, int power_kva = 100) {
    std::string const text =
        "gridspace_network: 1\nname: t\nbase: {frequency_hz: 60, power_kva: " + std::to_string(power_kva) + "}\n" +
        std::string{body};
    config::Diagnostics diagnostics;
    auto const root = config::parse_yaml(text, config::make_source("n.yaml", text), diagnostics);
    auto network = read_network(*root, diagnostics);
    EXPECT_TRUE(network.has_value()) << diagnostics.render();
    return network.value_or(Network{});
}

inline std::unique_ptr<Engine> started(Network network, TimeBase base, Rational step_s,
                                       std::shared_ptr<Team> team = nullptr) {
    auto engine = make_emt_engine(std::move(network), {base, base.nearest(step_s), 0, std::move(team)});
    EXPECT_TRUE(engine.has_value()) << (engine ? "" : describe(engine.error()));
    auto const ok = (*engine)->initialise();
    EXPECT_TRUE(ok.has_value()) << (ok ? "" : describe(ok.error()));
    return std::move(*engine);
}

inline std::size_t signal_of(Engine const& engine, std::string const& name) {
    std::size_t const i = engine.find_signal(name);
    EXPECT_LT(i, engine.signals().size()) << name;
    return i;
}

inline double read(Engine const& engine, std::string const& name) {
    return engine.value(signal_of(engine, name));
}

inline void advance(Engine& engine, SimTime t) {
    auto const ok = engine.advance(t);
    ASSERT_TRUE(ok.has_value()) << describe(ok.error());
}

inline void apply(Engine& engine, Action const& action) {
    auto const ok = engine.apply(action);
    ASSERT_TRUE(ok.has_value()) << describe(ok.error());
}

} // namespace gridspace::sim::emt

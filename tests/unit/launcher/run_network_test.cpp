// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/run_network.hpp"

#include "common/config/yaml.hpp"
#include "launcher/judge/number_at.hpp"

#include <fstream>
#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

namespace fs = std::filesystem;

struct RunNetwork : testing::Test {
    fs::path folder = fs::path{testing::TempDir()} / "run_network";

    RunNetwork() {
        fs::remove_all(folder);
        fs::create_directories(folder);
    }
    ~RunNetwork() override { fs::remove_all(folder); }
    RunNetwork(RunNetwork const&) = delete;
    RunNetwork& operator=(RunNetwork const&) = delete;

    void write(char const* name, char const* text) const { std::ofstream{folder / name} << text; }
    static config::Node yaml(char const* text) {
        config::Diagnostics diagnostics;
        return config::parse_yaml(text, config::make_source("x.yaml", text), diagnostics).value_or(config::Node::map());
    }
};

TEST_F(RunNetwork, HasTheChangesOfTheScenario) {
    write("network.yaml", "base: {frequency_hz: 50}\nloads: {L1: {p_kw: 4, bus: B}}\n");
    auto const sut = network_of_run(folder, yaml("simulation: {network_changes: {loads: {L1: {p_kw: 9}}}}\n"));
    config::Node const* load = sut.find("loads")->find("L1");
    EXPECT_EQ(number_at(load, "p_kw"), 9);
    EXPECT_EQ(load->find("bus")->text, "B");
}

TEST_F(RunNetwork, OfAnotherFormatIsTheChangesAlone) {
    auto const sut = network_of_run(folder, yaml("simulation: {network_changes: {cts: {CT1: {line: L}}}}\n"));
    EXPECT_NE(sut.find("cts")->find("CT1"), nullptr);
    EXPECT_TRUE(network_of_run(folder, config::Node::map()).is_map());
}

TEST_F(RunNetwork, HasTheFrequencyThatTheMonitorWasGiven) {
    EXPECT_EQ(frequency_of_run(folder), 60);
    write("monitor.yaml", "settings: {run: {frequency_hz: 50}}\n");
    EXPECT_EQ(frequency_of_run(folder), 50);
}

} // namespace
} // namespace gridspace::launcher

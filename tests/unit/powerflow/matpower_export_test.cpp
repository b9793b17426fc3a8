// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/matpower_export.hpp"

#include "common/config/diagnostics.hpp"
#include "common/source_tree.hpp"
#include "sim/network/network_config.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

namespace gridspace::sim {
namespace {

class MatpowerExport : public ::testing::TestWithParam<char const*> {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() / ("gridspace-export-" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    static Network load(std::filesystem::path const& file) {
        config::Diagnostics diagnostics;
        auto network = load_network(file, diagnostics);
        EXPECT_TRUE(network.has_value()) << diagnostics.render();
        return network ? std::move(*network) : Network{};
    }
    static PowerFlow solve(Network const& network, PowerFlowOptions const& options = {}) {
        auto flow = solve_power_flow(network, SwitchState{network}, options);
        EXPECT_TRUE(flow.has_value()) << (flow ? "" : describe(flow.error()));
        return flow.value_or(PowerFlow{});
    }
    Network exported(Network const& network, PowerFlow const& flow, PowerFlowOptions const& options = {}) const {
        std::filesystem::path const file = folder_ / "case.m";
        std::ofstream{file} << to_matpower(network, SwitchState{network}, options, flow);
        return load(file);
    }
    static void expect_same(PowerFlow const& given, PowerFlow const& again, double tolerance) {
        ASSERT_GE(again.buses.size(), given.buses.size());
        for (std::size_t i = 0; i < given.buses.size(); ++i) {
            EXPECT_NEAR(std::abs(again.buses[i].v - given.buses[i].v), 0, tolerance) << "bus " << i;
        }
        if (again.buses.size() == given.buses.size()) { // elsewhere the impedance of a source is a branch now
            EXPECT_NEAR(again.losses_kw, given.losses_kw, 1e-6 * std::abs(given.losses_kw) + 1e-6);
        }
    }

  private:
    std::filesystem::path folder_;
};

TEST_P(MatpowerExport, ReadBackHasTheSameSolution) {
    Network const network = load(source_tree(GetParam()));
    PowerFlow const flow = solve(network);
    expect_same(flow, solve(exported(network, flow)), 1e-8);
}
INSTANTIATE_TEST_SUITE_P(Networks, MatpowerExport,
                         ::testing::Values("configs/networks/ev_microgrid.yaml", "configs/networks/adn_set_a.yaml",
                                           "configs/networks/adn_set_a_islanded.yaml", "configs/networks/wscc9.yaml",
                                           "configs/networks/kundur_two_area.yaml", "configs/networks/feeder.yaml",
                                           "configs/networks/house.yaml", "tests/golden/powerflow/case9.m",
                                           "tests/golden/powerflow/case14.m", "tests/golden/powerflow/case33bw.m",
                                           "tests/golden/powerflow/case57.m", "tests/golden/powerflow/case118.m"));

TEST_F(MatpowerExport, AGeneratorThatGaveUpItsVoltageIsAGivenPower) {
    PowerFlowOptions options;
    options.enforce_q_limits = true;
    Network const network = load(source_tree("tests/golden/powerflow/case30.m"));
    PowerFlow const flow = solve(network, options);
    expect_same(flow, solve(exported(network, flow, options)), 1e-8);
}

TEST_F(MatpowerExport, WhatElseInjectsAtABusIsWithinTheLimitsOfItsGenerator) {
    PowerFlowOptions options;
    options.enforce_q_limits = true;
    Network network = load(source_tree("tests/golden/powerflow/case14.m"));
    Generator& given = network.generators.back();
    Generator extra = given;
    extra.name.name = "extra";
    extra.role = GeneratorRole::pq;
    extra.p_kw = 0;
    extra.q_kvar = 1e4;
    extra.q_min_kvar = extra.q_max_kvar = std::nullopt;
    given.q_max_kvar = 9e3; // it gives 7.6 Mvar beside them, and with them more than 9
    network.generators.push_back(extra);
    PowerFlow const flow = solve(network, options);
    expect_same(flow, solve(exported(network, flow, options), options), 1e-8);
}

} // namespace
} // namespace gridspace::sim

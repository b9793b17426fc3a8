// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "common/source_tree.hpp"
#include "common/text.hpp"
#include "sim/network/matlab_case.hpp"
#include "sim/network/network_config.hpp"
#include "sim/powerflow/power_flow.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <numbers>
#include <set>

namespace gridspace::sim {
namespace {

std::string const kFolder = source_tree("tests/golden/powerflow/");

double degrees(Complex v) {
    return std::arg(v) * 180 / std::numbers::pi;
}

struct Case {
    Network network;
    PowerFlow result;
};

Case solve(std::string const& name, PowerFlowOptions const& options = {}) {
    config::Diagnostics diagnostics;
    auto network = load_network(kFolder + name, diagnostics);
    EXPECT_TRUE(network.has_value()) << diagnostics.render();
    auto result = solve_power_flow(*network, SwitchState{*network}, options);
    EXPECT_TRUE(result.has_value()) << result.error().message;
    return {std::move(*network), std::move(*result)};
}

class PublishedCase : public ::testing::TestWithParam<std::filesystem::path> {};

TEST_P(PublishedCase, AgreesWithTheIndependentReference) {
    Case const sut = solve(GetParam().filename().string());
    EXPECT_LE(sut.result.mismatch_pu, 1e-8);
    std::filesystem::path csv = GetParam();
    std::ifstream reference{csv.replace_extension(".reference.csv")};
    std::string line;
    std::getline(reference, line);
    std::size_t rows = 0;
    for (; std::getline(reference, line); ++rows) {
        auto const cells = split(line, ',');
        std::size_t const bus = index_of(sut.network.buses, "B" + cells[0]);
        ASSERT_LT(bus, sut.network.buses.size());
        EXPECT_NEAR(std::abs(sut.result.buses[bus].v), std::stod(cells[1]), 1e-8) << "bus " << cells[0];
        EXPECT_NEAR(degrees(sut.result.buses[bus].v), std::stod(cells[2]), 1e-6) << "bus " << cells[0];
    }
    EXPECT_EQ(rows, sut.network.buses.size());
}

std::vector<std::filesystem::path> cases_with_reference() {
    std::vector<std::filesystem::path> out;
    for (auto const& file : std::filesystem::directory_iterator{kFolder}) {
        if (file.path().extension() == ".m") {
            out.push_back(file.path());
        }
    }
    std::sort(out.begin(), out.end());
    return out;
}

INSTANTIATE_TEST_SUITE_P(Golden, PublishedCase, ::testing::ValuesIn(cases_with_reference()),
                         [](auto const& param) { return param.param.stem().string(); });

TEST(PublishedCases, Ieee14HasTheVoltagesOfTheArchiveToTheirPrintedDigits) {
    Case const sut = solve("case14.m");
    constexpr double kV[] = {1.06, 1.045, 1.01,  1.019, 1.02,  1.07, 1.062,
                             1.09, 1.056, 1.051, 1.057, 1.055, 1.05, 1.036};
    constexpr double kAngle[] = {0,      -4.98,  -12.72, -10.33, -8.78,  -14.22, -13.37,
                                 -13.36, -14.94, -15.10, -14.79, -15.07, -15.16, -16.04};
    for (std::size_t i = 0; i < 14; ++i) {
        EXPECT_NEAR(std::abs(sut.result.buses[i].v), kV[i], 0.0015) << "bus " << i + 1; // three printed digits
        EXPECT_NEAR(degrees(sut.result.buses[i].v), kAngle[i], 0.02) << "bus " << i + 1;
    }
}

/// The columns Vm and Va of a case file hold the published solution.
void expect_published_columns(std::string const& name, double v_tolerance, double angle_tolerance_deg,
                              std::set<std::string> const& but = {}, PowerFlowOptions const& options = {}) {
    Case const sut = solve(name, options);
    std::ifstream file{kFolder + name};
    std::string const text{std::istreambuf_iterator<char>{file}, {}};
    config::Diagnostics diagnostics;
    MatlabCase const data = read_matlab_case(text, config::make_source(name, text), diagnostics);
    std::size_t compared = 0;
    for (auto const& row : data.matrices.at("bus").rows) {
        std::string const bus = "B" + std::to_string(static_cast<int>(row[0]));
        if (but.contains(bus)) {
            continue;
        }
        Complex const v = sut.result.buses[index_of(sut.network.buses, bus)].v;
        EXPECT_NEAR(std::abs(v), row[7], v_tolerance) << name << " " << bus;
        EXPECT_NEAR(degrees(v), row[8], angle_tolerance_deg) << name << " " << bus;
        ++compared;
    }
    EXPECT_EQ(compared + but.size(), sut.network.buses.size());
}

TEST(PublishedCases, GraingerAndStevensonHasTheSolutionOfTheBook) {
    expect_published_columns("case4gs.m", 0.000006, 0.0006);
}

TEST(PublishedCases, NewEnglandHasThePublishedSolutionToItsEightDigits) {
    expect_published_columns("case39.m", 6e-8, 6e-7);
}

TEST(PublishedCases, Ieee57HasTheVoltagesOfTheArchiveButForItsBus46) {
    expect_published_columns("case57.m", 0.001, 0.06, {"B46"});
}

TEST(PublishedCases, Ieee118HasTheVoltagesOfTheArchiveWhenGeneratorsKeepTheirReactiveLimitsButForItsBus30) {
    PowerFlowOptions limits;
    limits.enforce_q_limits = true;
    expect_published_columns("case118.m", 0.001, 0.32, {"B30"}, limits);
    // Without limits bus 103 would be at its set point, 1.01 p.u.; the archive has 1.001.
    Case const free = solve("case118.m");
    EXPECT_NEAR(std::abs(free.result.buses[index_of(free.network.buses, "B103")].v), 1.01, 1e-9);
}

TEST(PublishedCases, BaranAndWuHasTheLossesAndTheLowestVoltageOfThePaper) {
    Case const sut = solve("case33bw.m");
    EXPECT_NEAR(sut.result.losses_kw, 202.68, 0.01);
    auto const lowest = std::min_element(sut.result.buses.begin(), sut.result.buses.end(),
                                         [](auto const& a, auto const& b) { return std::abs(a.v) < std::abs(b.v); });
    EXPECT_EQ(lowest - sut.result.buses.begin(), 17);
    EXPECT_NEAR(std::abs(lowest->v), 0.9131, 0.00005);
}

} // namespace
} // namespace gridspace::sim

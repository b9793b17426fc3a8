// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/three_phase.hpp"

#include "sim/network/network_config.hpp"
#include "sim/powerflow/power_flow.hpp"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>

namespace gridspace::sim {
namespace {

Network shipped(std::string const& file) {
    config::Diagnostics diagnostics;
    auto network = load_network(std::string{GRIDSPACE_SOURCE_DIR} + "/configs/networks/" + file, diagnostics);
    EXPECT_TRUE(network.has_value()) << diagnostics.render();
    return network.value_or(Network{});
}

double degrees(Complex x) {
    return std::arg(x) * 180 / std::numbers::pi;
}

/// The published table has whole volts and tenths of a degree.
void expect_table(Phases const& got, std::array<double, 3> volts, std::array<double, 3> angles, char const* what) {
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(std::abs(got[k]), volts[k], 1.0) << what << ' ' << k;
        EXPECT_NEAR(std::remainder(degrees(got[k]) - angles[k], 360), 0, 0.1) << what << ' ' << k;
    }
}

TEST(ThreePhasePowerFlow, ReproducesTheIeee4NodeFeederBetweenEarthedStars) {
    Network const n = shipped("ieee4_wye_wye.yaml");
    auto const flow = solve_three_phase(n, SwitchState{n});
    ASSERT_TRUE(flow.has_value()) << describe(flow.error());
    expect_table(flow->buses[1], {7164, 7110, 7082}, {-0.1, -120.2, 119.3}, "N2");
    expect_table(flow->buses[2], {2305, 2255, 2203}, {-2.3, -123.6, 114.8}, "N3");
    expect_table(flow->buses[3], {2175, 1930, 1833}, {-4.1, -126.8, 102.8}, "N4");
}

TEST(ThreePhasePowerFlow, ReproducesTheIeee4NodeFeederFromDeltaToEarthedStar) {
    Network const n = shipped("ieee4_delta_wye.yaml");
    auto const flow = solve_three_phase(n, SwitchState{n});
    ASSERT_TRUE(flow.has_value()) << describe(flow.error());
    Phases const& v = flow->buses[1];
    expect_table({v[0] - v[1], v[1] - v[2], v[2] - v[0]}, {12350, 12314, 12333}, {29.6, -90.4, 149.8},
                 "N2, line to line");
    expect_table(flow->buses[2], {2290, 2261, 2214}, {-32.4, -153.8, 85.2}, "N3");
    expect_table(flow->buses[3], {2157, 1936, 1849}, {-34.2, -157.0, 73.4}, "N4");
}

TEST(ThreePhasePowerFlow, ABalancedNetworkHasTheVoltagesOfTheBalancedPowerFlow) {
    Network n = shipped("ieee4_wye_wye.yaml");
    n.line_types[0].phase_r_ohm_per_km.clear(); // the transposed line
    n.line_types[0].phase_x_ohm_per_km.clear();
    n.loads[0].phase_p_kw.clear();
    n.loads[0].phase_q_kvar.clear();
    auto const flow = solve_three_phase(n, SwitchState{n});
    auto const balanced = solve_power_flow(n, SwitchState{n});
    ASSERT_TRUE(flow.has_value());
    ASSERT_TRUE(balanced.has_value());
    for (std::size_t i = 0; i < n.buses.size(); ++i) {
        double const nominal = n.buses[i].voltage_v / std::sqrt(3.0);
        EXPECT_NEAR(std::abs(flow->buses[i][0]) / nominal, std::abs(balanced->buses[i].v), 1e-6);
        EXPECT_NEAR(std::abs(flow->buses[i][1]), std::abs(flow->buses[i][2]), 1e-4);
    }
}

TEST(ThreePhasePowerFlow, TwoSourcesThatHoldDifferentVoltagesAtOnePlaceAreAnError) {
    Network n = shipped("ieee4_wye_wye.yaml");
    n.generators.push_back(n.generators.front());
    EXPECT_TRUE(solve_three_phase(n, SwitchState{n}).has_value()); // the same voltage twice contradicts nothing
    n.generators.back().voltage_setpoint_pu = 1.01;
    auto const flow = solve_three_phase(n, SwitchState{n});
    ASSERT_FALSE(flow.has_value());
    EXPECT_THAT(flow.error().message, testing::HasSubstr("holds bus 'N1' at another voltage"));
}

TEST(ThreePhasePowerFlow, MoreThanTheFeederCanCarryIsAnError) {
    Network n = shipped("ieee4_wye_wye.yaml");
    for (double& p : n.loads[0].phase_p_kw) {
        p *= 10;
    }
    n.loads[0].model = LoadModel::exponential; // exponent 0 with the floor at 0.7: still solvable as an impedance
    auto const flow = solve_three_phase(n, SwitchState{n}, {.max_iterations = 20});
    ASSERT_FALSE(flow.has_value());
    EXPECT_THAT(flow.error().message, testing::HasSubstr("does not converge"));
}

} // namespace
} // namespace gridspace::sim

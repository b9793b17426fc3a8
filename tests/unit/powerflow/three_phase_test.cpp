// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/three_phase.hpp"

#include "common/config/yaml.hpp"
#include "common/source_tree.hpp"
#include "sim/network/network_config.hpp"
#include "sim/powerflow/power_flow.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>

namespace gridspace::sim {
namespace {

Network shipped(std::string const& file) {
    config::Diagnostics diagnostics;
    auto network = load_network(source_tree("configs/networks/") + file, diagnostics);
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

/// A 400 V network behind a transformer, with its windings; `load` is the rest of the load's settings.
Network behind(std::string const& from, std::string const& to, int shift_deg, std::string const& load) {
    std::string const text = fmt::format(
        "gridspace_network: 1\nname: t\nbase: {{frequency_hz: 50, power_kva: 400}}\n"
        "buses: {{H: {{voltage_v: 11000}}, L: {{voltage_v: 400}}}}\n"
        "sources: {{S: {{bus: H, r_ohm: 0.5, l_mh: 5}}}}\n"
        "transformers: {{T: {{from: H, to: L, rating_kva: 400, r_percent: 1.2, x_percent: 4, charging_percent: 50, "
        "magnetising_percent: 5, from_winding: {}, to_winding: {}, phase_shift_deg: {}}}}}\n"
        "loads: {{W: {{bus: L, {}}}}}\n",
        from, to, shift_deg, load);
    config::Diagnostics diagnostics;
    auto const root = config::parse_yaml(text, config::make_source("n.yaml", text), diagnostics);
    auto network = read_network(*root, diagnostics);
    EXPECT_TRUE(network.has_value()) << diagnostics.render();
    return std::move(*network);
}

struct Windings {
    char const *from, *to;
    int shift_deg;
};
constexpr Windings kWindings[]{
    {"wye_grounded", "wye_grounded", 0}, {"wye_grounded", "wye", 0}, {"wye_grounded", "delta", 30},
    {"wye_grounded", "delta", -30},      {"wye", "wye_grounded", 0}, {"wye", "delta", 30},
    {"delta", "wye_grounded", -30},      {"delta", "wye", 30},       {"delta", "delta", 0}};

TEST(ThreePhasePowerFlow, EveryWindingGivesABalancedNetworkTheVoltagesOfTheBalancedPowerFlow) {
    for (Windings const& w : kWindings) {
        for (char const* load :
             {"p_kw: 200, power_factor: 0.9", "p_kw: 200, power_factor: 0.9, model: constant_impedance"}) {
            SCOPED_TRACE(fmt::format("{} {} {} {}", w.from, w.to, w.shift_deg, load));
            Network const n = behind(w.from, w.to, w.shift_deg, load);
            auto const flow = solve_three_phase(n, SwitchState{n});
            auto const balanced = solve_power_flow(n, SwitchState{n});
            ASSERT_TRUE(flow.has_value()) << describe(flow.error());
            ASSERT_TRUE(balanced.has_value()) << describe(balanced.error());
            for (std::size_t k = 0; k < 3; ++k) { // with its charging and its magnetising current
                Complex const turn =
                    std::polar(400 / std::sqrt(3.0), -2 * std::numbers::pi / 3 * static_cast<double>(k));
                EXPECT_NEAR(std::abs(flow->buses[1][k] / turn - balanced->buses[1].v), 0, 1e-6) << k;
            }
        }
    }
}

TEST(ThreePhasePowerFlow, AnUnbalancedImpedanceBehindWindingsWithoutEarthHasTheVoltagesOfItsStar) {
    // Phase currents must add up to zero: the potential of the three phases floats until the load's own do.
    Network const n = behind("wye_grounded", "delta", 30,
                             "phase_p_kw: [60, 20, 90], phase_q_kvar: [10, 5, -20], model: constant_impedance");
    auto const flow = solve_three_phase(n, SwitchState{n});
    ASSERT_TRUE(flow.has_value()) << describe(flow.error());
    double const v2 = 400.0 * 400.0 / 3, c = 0.5 / 2 * 400e3 / (400.0 * 400.0); // siemens of the charging
    Complex const loads[]{{60e3, -10e3}, {20e3, -5e3}, {90e3, 20e3}};
    Complex sum{};
    double sizes = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        Complex const i = (loads[k] / v2 + Complex{0, c}) * flow->buses[1][k];
        sum += i;
        sizes += std::abs(i);
    }
    EXPECT_LT(std::abs(sum), 1e-6 * sizes);
    EXPECT_GT(std::abs(flow->buses[1][1]), 1.3 * std::abs(flow->buses[1][2])); // the lightest phase rises
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

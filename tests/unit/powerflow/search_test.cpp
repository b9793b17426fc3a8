// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/search.hpp"

#include "common/config/yaml.hpp"
#include "sim/network/network_config.hpp"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>

namespace gridspace::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Network network_of(std::string_view body) {
    std::string const text =
        "gridspace_network: 1\nname: t\nbase: {frequency_hz: 60, power_kva: 100}\n" + std::string{body};
    config::Diagnostics diagnostics;
    auto const root = config::parse_yaml(text, config::make_source("n.yaml", text), diagnostics);
    auto network = read_network(*root, diagnostics);
    EXPECT_TRUE(network.has_value()) << diagnostics.render();
    return std::move(*network);
}

// 0.1 + j0.2 p.u. from an ideal source to half a p.u. of load: 0.86 p.u., or 0.26 p.u. on the lower branch of the nose
// curve.
Network two_buses() {
    return network_of("buses: {A: {voltage_v: 480}, B: {voltage_v: 480}}\n"
                      "lines: {L: {from: A, to: B, r_ohm: 0.2304, x_ohm: 0.4608}}\n"
                      "generators: {G: {bus: A, role: slack}}\n"
                      "loads: {D: {bus: B, p_kw: 50, q_kvar: 20}}\n");
}

TEST(PowerFlowSearch, BeginsWithTheSolutionThatCameWithTheNetwork) {
    Network n = two_buses();
    auto const flat = solve_power_flow(n, SwitchState{n});
    ASSERT_TRUE(flat.has_value());
    for (std::size_t i = 0; i < n.buses.size(); ++i) {
        n.buses[i].start = {std::abs(flat->buses[i].v), std::arg(flat->buses[i].v) / kDegree};
    }
    auto const sut = solve_power_flow(n, SwitchState{n});
    ASSERT_TRUE(sut.has_value());
    EXPECT_GT(flat->iterations, 2);
    EXPECT_LE(sut->iterations, 1);
}

TEST(PowerFlowSearch, ASolutionThatNobodyWouldBelieveIsNotTakenWhereThereIsABetterOne) {
    Network n = two_buses();
    n.buses[0].start = {1, 0};
    n.buses[1].start = {0.3, -25}; // from here Newton's method finds the lower branch
    PowerFlowProblem const problem = make_problem(n, SwitchState{n}, {});
    NewtonOutcome const lower = newton(problem, {}, 1, &*problem.given);
    ASSERT_TRUE(lower.converged);
    ASSERT_LT(lower.v[1], 0.5);
    EXPECT_THAT(doubts_about(n, problem, lower), testing::Contains(testing::HasSubstr("the lowest is 'B' at")));

    SearchOutcome const sut = search(n, problem, {});
    EXPECT_TRUE(sut.solution.converged);
    EXPECT_GT(sut.solution.v[1], 0.8);
    EXPECT_THAT(sut.doubts, testing::IsEmpty());
}

TEST(PowerFlowSearch, WhereTheOnlySolutionIsHardToBelieveItIsGivenWithItsDoubts) {
    Network n = two_buses();
    n.loads[0].p_kw = 75;
    n.loads[0].q_kvar = 45;
    auto const sut = solve_power_flow(n, SwitchState{n});
    ASSERT_TRUE(sut.has_value());
    EXPECT_LT(std::abs(sut->buses[1].v), 0.8);
    EXPECT_THAT(sut->doubts, testing::ElementsAre(testing::HasSubstr("1 of 2 buses are below 0.8 p.u.")));
}

TEST(PowerFlowSearch, OfARefusedOneItIsSaidHowFarThePathFromNoLoadGoes) {
    Network n = two_buses();
    n.loads[0].p_kw = 500;
    n.loads[0].q_kvar = 200;
    PowerFlowProblem const problem = make_problem(n, SwitchState{n}, {});
    SearchOutcome const sut = search(n, problem, {});
    EXPECT_FALSE(sut.solution.converged);
    // The nose of V^4 + (2 (RP + XQ) - E^2) V^2 + Z^2 S^2 = 0: (2 k 0.9 - 1)^2 = 4 * 0.05 * 29 k^2.
    double const nose = 1 / (2 * 0.9 + 2 * std::sqrt(0.05 * 29));
    EXPECT_LT(sut.reached, nose);
    EXPECT_GT(sut.reached, nose - 0.02);
}

TEST(LinearStart, PhaseShiftersInAMeshTurnEachBusByItsShare) {
    // Three equal branches in a ring, one of them with a shift of 30 degrees: the sum around the ring cannot vanish, so
    // each branch carries a third of it. Breadth first, one bus would have been turned by the whole.
    Network const n = network_of("buses: {A: {voltage_v: 480}, B: {voltage_v: 480}, C: {voltage_v: 480}}\n"
                                 "transformers:\n"
                                 "  T1: {from: A, to: B, rating_kva: 100, x_percent: 10, phase_shift_deg: 30}\n"
                                 "  T2: {from: B, to: C, rating_kva: 100, x_percent: 10}\n"
                                 "  T3: {from: A, to: C, rating_kva: 100, x_percent: 10}\n"
                                 "generators: {G: {bus: A, role: slack}}\n");
    PowerFlowProblem const problem = make_problem(n, SwitchState{n}, {});
    PowerFlowStart const sut = linear_start(problem);
    EXPECT_NEAR(sut.angle[0], 0, 1e-12);
    EXPECT_NEAR(sut.angle[1], -20 * kDegree, 1e-12);
    EXPECT_NEAR(sut.angle[2], -10 * kDegree, 1e-12);
}

} // namespace
} // namespace gridspace::sim

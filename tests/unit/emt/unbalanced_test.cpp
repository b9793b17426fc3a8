// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Waveforms of unbalanced networks: the IEEE 4-node feeder, faults on a line that is not transposed.
#include "tests/unit/emt/emt_fixture.hpp"

#include "sim/powerflow/three_phase.hpp"

#include <cmath>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

TimeBase const kBase{Rational{1, 48000}};
constexpr int kCycle = 800;

/// Phasors (r.m.s.) of three signals over the cycle that ends `cycles` from now.
Phases phasors(Engine& sut, std::string const& name, int& step, int cycles) {
    std::array<std::size_t, 3> const s{signal_of(sut, name + ".a"), signal_of(sut, name + ".b"),
                                       signal_of(sut, name + ".c")};
    Phases out{};
    int const last = step + cycles * kCycle;
    while (step < last) {
        advance(sut, SimTime{++step});
        if (step > last - kCycle) {
            for (std::size_t k = 0; k < 3; ++k) {
                out[k] +=
                    sut.value(s[k]) * std::polar(std::numbers::sqrt2 / kCycle, -2 * std::numbers::pi * step / kCycle);
            }
        }
    }
    return out;
}

double degrees(Complex x) {
    return std::arg(x) * 180 / std::numbers::pi;
}

struct Row {
    char const* bus;
    std::array<double, 3> volts, angles;
};

void expect_rows(std::string const& file, std::vector<Row> const& rows) {
    for (Row const& row : rows) {
        auto const sut = started(shipped_network(file), kBase, Rational{1, 48000});
        int step = 0;
        Phases const first = phasors(*sut, std::string{"bus."} + row.bus + ".v", step, 1);
        Phases const later = phasors(*sut, std::string{"bus."} + row.bus + ".v", step, 5);
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(std::abs(first[k]), row.volts[k], 1.0) << row.bus << k; // the table has whole volts
            EXPECT_NEAR(std::remainder(degrees(first[k]) - row.angles[k], 360), 0, 0.1) << row.bus << k;
            EXPECT_NEAR(std::abs(later[k] - first[k]), 0, 5e-3) << row.bus << k; // it starts settled
        }
    }
}

TEST(EmtUnbalanced, TheIeee4NodeFeederHasItsPublishedVoltagesFromTheFirstCycleOn) {
    expect_rows("ieee4_wye_wye.yaml", {{"N2", {7164, 7110, 7082}, {-0.1, -120.2, 119.3}},
                                       {"N3", {2305, 2255, 2203}, {-2.3, -123.6, 114.8}},
                                       {"N4", {2175, 1930, 1833}, {-4.1, -126.8, 102.8}}});
}

TEST(EmtUnbalanced, TheIeee4NodeFeederBehindADeltaHasItsPublishedVoltages) {
    expect_rows("ieee4_delta_wye.yaml",
                {{"N3", {2290, 2261, 2214}, {-32.4, -153.8, 85.2}}, {"N4", {2157, 1936, 1849}, {-34.2, -157.0, 73.4}}});
}

TEST(EmtUnbalanced, AnEarthFaultInsideALineThatIsNotTransposedDrawsWhatTheThreePhasePowerFlowSays) {
    constexpr double kOhm = 5, kShare = 0.3;
    Network n = shipped_network("ieee4_wye_wye.yaml");
    n.loads[0].model = LoadModel::constant_impedance;
    // The oracle has a bus at the fault, and the resistance as a load of one phase.
    Network with_bus = n;
    Bus middle = with_bus.buses[1];
    middle.name.name = "M";
    with_bus.buses.push_back(middle);
    Line rest = with_bus.lines[0];
    rest.name.name = "REST";
    rest.from.name = "M";
    rest.length_km = *rest.length_km * (1 - kShare);
    with_bus.lines[0].to.name = "M";
    with_bus.lines[0].length_km = *with_bus.lines[0].length_km * kShare;
    with_bus.lines.push_back(rest);
    Load fault = with_bus.loads[0];
    fault.name.name = "F";
    fault.bus.name = "M";
    double const phase_v = 12470 / std::sqrt(3.0);
    fault.phase_p_kw = {phase_v * phase_v / kOhm / 1e3, 0, 0};
    fault.phase_q_kvar = {0, 0, 0};
    with_bus.loads.push_back(fault);
    auto const oracle = solve_three_phase(with_bus, SwitchState{with_bus});
    ASSERT_TRUE(oracle.has_value()) << describe(oracle.error());

    auto const sut = started(n, kBase, Rational{1, 48000});
    int step = 0;
    Phases const before = phasors(*sut, "line.L12.from.i", step, 1);
    apply(*sut, ApplyFault{"L12", "", 100 * kShare, FaultType::phase_ground, kOhm, "f"});
    Phases const got = phasors(*sut, "line.L12.from.i", step, 30);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(std::abs(got[k] - oracle->branches[0].from[k]), 0, 1e-3 * std::abs(oracle->branches[0].from[0]))
            << k;
    }
    EXPECT_GT(std::abs(got[0]), 3 * std::abs(before[0])); // it is a fault
}

} // namespace
} // namespace gridspace::sim::emt

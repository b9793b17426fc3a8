// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Batteries and DC loads behind averaged converters in waveforms.
#include "tests/unit/emt/emt_fixture.hpp"

#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>

namespace gridspace::sim::emt {
namespace {

using testing::HasSubstr;

TimeBase const kBase{Rational{1, 48000}};
constexpr std::string_view kBus = "buses: {A: {voltage_v: 400}}\nsources: {S: {bus: A, r_ohm: 0.01, l_mh: 0.1}}\n"
                                  "loads: {D: {bus: A, p_kw: 1, model: constant_impedance}}\n";

void run(Engine& sut, int from, int to) {
    for (int n = from + 1; n <= to; ++n) {
        advance(sut, SimTime{n});
    }
}

TEST(EmtBattery, GivesItsPowerFromTheStartAndStopsExactlyWhenItIsEmpty) {
    auto const sut =
        started(network_of(std::string{kBus} +
                           "batteries: {X: {bus: A, capacity_kwh: 0.001, rating_kva: 20, p_kw: 9, q_kvar: 2, "
                           "efficiency: 0.9, soc_start_percent: 50, soc_min_percent: 20}}\n"),
                kBase, Rational{1, 48000});
    EXPECT_NEAR(read(*sut, "battery.X.p_kw"), 9, 1e-3);
    EXPECT_NEAR(read(*sut, "battery.X.q_kvar"), 2, 1e-3);
    run(*sut, 0, 2400);
    EXPECT_NEAR(read(*sut, "battery.X.p_kw"), 9, 1e-3);
    EXPECT_NEAR(read(*sut, "battery.X.soc_percent"), 50 - 100 * 10e3 * 0.05 / 3600,
                0.02); // 9 kW / 0.9 for 50 ms out of 1 Wh
    run(*sut, 2400, 9600);
    EXPECT_EQ(read(*sut, "battery.X.soc_percent"), 20);
    EXPECT_NEAR(read(*sut, "battery.X.p_kw"), 0, 1e-3);
    EXPECT_NEAR(read(*sut, "battery.X.q_kvar"), 2, 1e-2); // its converter stays
    apply(*sut, SetParameter{"batteries.X.p_kw", -10});
    run(*sut, 9600, 12000);
    EXPECT_NEAR(read(*sut, "battery.X.p_kw"), -10, 1e-2);
    EXPECT_GT(read(*sut, "battery.X.soc_percent"), 25);
}

TEST(EmtBattery, KeepsItsCurrentWithinItsLimitInAFault) {
    auto const sut =
        started(network_of(std::string{kBus} + "batteries: {X: {bus: A, capacity_kwh: 1, rating_kva: 20, p_kw: 20}}\n"),
                kBase, Rational{1, 48000});
    double const rated = std::sqrt(2.0) * 20e3 / (std::sqrt(3.0) * 400);
    apply(*sut, ApplyFault{"", "A", 0, FaultType::three_phase_ground, 0.005, "f"});
    run(*sut, 0, 4800);
    double peak = 0;
    for (int n = 4801; n <= 5600; ++n) {
        advance(*sut, SimTime{n});
        peak = std::max(peak, std::abs(read(*sut, "battery.X.i.a")));
    }
    EXPECT_NEAR(peak, 1.2 * rated, 0.02 * rated);
}

TEST(EmtBattery, TakenOutOfServiceItNeitherGivesNorAges) {
    auto const sut = started(
        network_of(std::string{kBus} + "batteries: {X: {bus: A, capacity_kwh: 0.1, rating_kva: 20, p_kw: 20}}\n"),
        kBase, Rational{1, 48000});
    apply(*sut, Disconnect{"X"});
    run(*sut, 0, 480);
    double const soc = read(*sut, "battery.X.soc_percent");
    run(*sut, 480, 960);
    EXPECT_EQ(read(*sut, "battery.X.soc_percent"), soc);
    EXPECT_NEAR(read(*sut, "battery.X.p_kw"), 0, 1e-9);
}

TEST(EmtDcLoad, HoldsItsPowerInASagWhereAResistiveOneFollowsTheVoltage) {
    auto network = network_of("buses: {A: {voltage_v: 400}}\nsources: {S: {bus: A, r_ohm: 0.01, l_mh: 0.1}}\n"
                              "loads:\n  C: {bus: A, p_kw: 10, model: dc_constant_power}\n"
                              "  R: {bus: A, p_kw: 10, model: dc_resistive}\n");
    auto const both = started(std::move(network), kBase, Rational{1, 48000});
    EXPECT_NEAR(read(*both, "load.C.p_kw"), 10, 1e-2);
    EXPECT_NEAR(read(*both, "load.C.q_kvar"), 0, 1e-2);
    apply(*both, SetParameter{"sources.S.voltage_pu", 0.9});
    run(*both, 0, 4800);
    double const v = read(*both, "bus.A.v_pu");
    EXPECT_NEAR(read(*both, "load.C.p_kw"), 10, 0.02);
    EXPECT_NEAR(read(*both, "load.R.p_kw"), 10 * v * v, 0.02);
    apply(*both, SetParameter{"sources.S.voltage_pu", 0.5}); // its current is at the limit: 1.2 of nominal
    run(*both, 4800, 14400);
    EXPECT_NEAR(read(*both, "load.C.p_kw"), 12 * read(*both, "bus.A.v_pu"), 0.05);
    auto const refused = both->apply(SetParameter{"loads.C.q_kvar", 1});
    ASSERT_FALSE(refused.has_value());
    EXPECT_THAT(refused.error().message, HasSubstr("a DC load has only p_kw"));
}

TEST(EmtRefusals, AStepThatCannotShowAPeriodOrAHarmonicIsRefused) {
    auto const coarse = make_emt_engine(network_of(kBus), {TimeBase{Rational{1, 100}}, SimSpan{1}, 0});
    ASSERT_FALSE(coarse.has_value());
    EXPECT_THAT(coarse.error().message, HasSubstr("a step of 0.01 s is too long for 60 Hz"));
    auto const harmonic = make_emt_engine(network_of("buses: {A: {voltage_v: 400}}\nloads: {D: {bus: A, p_kw: 1}}\n"
                                                     "sources: {S: {bus: A, harmonics: [{order: 401, percent: 1}]}}\n"),
                                          {kBase, SimSpan{1}, 0});
    ASSERT_FALSE(harmonic.has_value());
    EXPECT_THAT(harmonic.error().message, HasSubstr("harmonic 401 of source 'S'"));
}

} // namespace
} // namespace gridspace::sim::emt

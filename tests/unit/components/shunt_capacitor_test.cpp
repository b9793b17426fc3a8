// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/events/event.hpp"
#include "sim/powerflow/power_flow.hpp"
#include "sim/powerflow/three_phase.hpp"
#include "tests/unit/components/element_fixture.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

/// A bank of 60 kvar at 0.42 kV on a 0.4 kV bus behind a resistance and an inductance.
namespace gridspace::sim {
namespace {

constexpr double kR = 0.05, kL = 0.5e-3, kV = 400, kKvar = 60, kRatedKv = 0.42, kOmega = 2 * std::numbers::pi * 60;
constexpr double kC = kKvar * 1e3 / (kRatedKv * kRatedKv * 1e6) / kOmega;
TimeBase const kBase{Rational{1, 48000}};

/// Voltage at the bank, p.u.: v = e / (1 - w^2 L C + j w R C).
double const kRise = 1 / std::abs(Complex{1 - kOmega * kOmega * kL * kC, kOmega* kR* kC});

Network network(std::string const& state) {
    std::string const text = "gridspace_network: 1\nname: t\nbase: {frequency_hz: 60, power_kva: 100}\n"
                             "buses: {A: {voltage_v: 400}}\nsources: {S: {bus: A, r_ohm: 0.05, l_mh: 0.5}}\n"
                             "shunt_capacitors: {C: {bus: A, q_kvar: 60, rated_kv: 0.42, state: " +
                             state + "}}\n";
    Network n;
    auto const diagnostics = read_text(text, n);
    EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    return n;
}

std::unique_ptr<Engine> started(std::string const& solver, std::string const& state) {
    auto engine = make(solver, network(state), kBase);
    must(engine->initialise());
    return engine;
}

TEST(ShuntCapacitor, RaisesTheVoltageInBothPowerFlowsAsTheImpedanceSays) {
    Network const closed = network("closed"), open = network("open");
    auto const balanced = solve_power_flow(closed, SwitchState{closed});
    ASSERT_TRUE(balanced.has_value());
    EXPECT_NEAR(std::abs(balanced->buses[0].v), kRise, 1e-9);
    auto const by_phase = solve_three_phase(closed, SwitchState{closed}, {});
    ASSERT_TRUE(by_phase.has_value());
    EXPECT_NEAR(std::abs(by_phase->buses[0][1]) * std::sqrt(3.0) / kV, kRise, 1e-9);
    auto const without = solve_power_flow(open, SwitchState{open});
    ASSERT_TRUE(without.has_value());
    EXPECT_NEAR(std::abs(without->buses[0].v), 1, 1e-9);
}

class ShuntCapacitorIn : public testing::TestWithParam<char const*> {};
INSTANTIATE_TEST_SUITE_P(Solver, ShuntCapacitorIn, testing::Values("phasor", "emt"));

TEST_P(ShuntCapacitorIn, StartsSettledAndGivesItsReactivePower) {
    auto const sut = started(GetParam(), "closed");
    EXPECT_NEAR(read(*sut, "bus.A.v_pu"), kRise, 2e-5);
    EXPECT_NEAR(read(*sut, "shunt_capacitor.C.q_kvar"), kKvar * std::pow(kRise * kV / (1e3 * kRatedKv), 2), 1e-2);
    EXPECT_NEAR(read(*sut, "shunt_capacitor.C.p_kw"), 0, 1e-2);
    EXPECT_EQ(read(*sut, "shunt_capacitor.C.position"), 2);
}

TEST_P(ShuntCapacitorIn, IsSwitchedByEvents) {
    auto const sut = started(GetParam(), "open");
    EXPECT_NEAR(read(*sut, "bus.A.v_pu"), 1, 1e-5);
    EXPECT_EQ(read(*sut, "shunt_capacitor.C.position"), 1);
    must(sut->apply(SwitchBreaker{"C", true}));
    must(sut->advance(SimTime{} + SimSpan{24000})); // 25 time constants 2 L / R
    EXPECT_NEAR(read(*sut, "bus.A.v_pu"), kRise, 1e-4);
    must(sut->apply(SwitchBreaker{"C", false}));
    must(sut->advance(SimTime{} + SimSpan{48000}));
    EXPECT_NEAR(read(*sut, "bus.A.v_pu"), 1, 1e-4);
    EXPECT_NEAR(read(*sut, "shunt_capacitor.C.q_kvar"), 0, 1e-6);
    EXPECT_EQ(read(*sut, "shunt_capacitor.C.position"), 1);
}

TEST(ShuntCapacitor, IsEnergisedWithTheTransientOfAnRlcCircuit) {
    auto const sut = started("emt", "open");
    must(sut->apply(SwitchBreaker{"C", true}));
    // v = Re(V e^jwt) + e^-at (A cos bt + B sin bt) with v(0) = 0 and i(0) = C v'(0) = 0, phase a of a source cos wt.
    double const peak = kV * std::sqrt(2.0 / 3), a = kR / (2 * kL), b = std::sqrt(1 / (kL * kC) - a * a);
    Complex const v = peak / Complex{1 - kOmega * kOmega * kL * kC, kOmega * kR * kC};
    double const big_a = -v.real(), big_b = (a * big_a + kOmega * v.imag()) / b;
    for (int step : {24, 60, 130, 300, 700}) {
        double const t = step / 48000.0;
        must(sut->advance(SimTime{} + SimSpan{step}));
        double const exact = (v * std::polar(1.0, kOmega * t)).real() +
                             std::exp(-a * t) * (big_a * std::cos(b * t) + big_b * std::sin(b * t));
        EXPECT_NEAR(read(*sut, "bus.A.v.a"), exact, 2e-3 * peak) << step;
    }
}

TEST(ShuntCapacitor, AnEventMayOpenIt) {
    Network const n = network("closed");
    Event event;
    event.name = {"e", {}};
    event.open = {{"C", {}}};
    config::Diagnostics diagnostics;
    check_events({event}, n, true, diagnostics);
    EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    event.open = {{"D", {}}};
    check_events({event}, n, true, diagnostics);
    EXPECT_EQ(diagnostics.errors(), 1);
}

} // namespace
} // namespace gridspace::sim

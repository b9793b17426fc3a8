// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/step_choice.hpp"
#include "tests/unit/emt/emt_fixture.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <numbers>

/// Natural oscillations of circuits against their closed solutions, and the step that they ask for.
namespace gridspace::sim::emt {
namespace {

using testing::HasSubstr;

constexpr double kTwoPi = 2 * std::numbers::pi;

PhaseMatrix alike(double x) {
    return PhaseMatrix::sequence(x, x);
}

std::optional<Mode> mode_of(Circuit const& c, double least_var = 0) {
    std::vector<double> const peak_v(static_cast<std::size_t>(c.nodes()), 100);
    auto const mode = fastest_mode(c, switch_state(c, true), {peak_v, least_var});
    EXPECT_TRUE(mode.has_value());
    return mode.value_or(std::nullopt);
}

/// Source - r, l - node with c and a load of g to earth, `sections` times.
Circuit ladder(int sections, double r, double l, double cap, double g = 0) {
    Circuit c;
    int at = c.add_triple("source");
    c.sources.push_back({at, 100, 0, 60, {}, "S"});
    for (int k = 0; k < sections; ++k) {
        int const next = c.add_triple("n");
        c.add_rl(at, next, alike(r), alike(l));
        c.add_capacitor(next, kEarth, alike(cap));
        if (g > 0) {
            c.add_rl(next, kEarth, alike(1 / g), {});
        }
        at = next;
    }
    return c;
}

TEST(FastestMode, OfOneInductanceAndCapacitanceHasTheFrequencyAndDecayOfItsEquation) {
    double const r = 2, l = 1e-3, cap = 1e-6, g = 0.003;
    auto const mode = mode_of(ladder(1, r, l, cap, g));
    ASSERT_TRUE(mode.has_value());
    // l c s^2 + (r c + g l) s + 1 + r g = 0
    double const decay = (r / l + g / cap) / 2, square = (1 + r * g) / (l * cap) - decay * decay;
    EXPECT_NEAR(mode->frequency_hz, std::sqrt(square) / kTwoPi, 1e-5 * mode->frequency_hz);
    EXPECT_NEAR(mode->decay_per_s, decay, 1e-4 * decay);
}

TEST(FastestMode, OfALadderIsItsHighestEigenfrequency) {
    double const l = 1e-3, cap = 1e-6;
    for (int const n : {2, 3, 12, 200}) { // 200: more nodes than steps of Lanczos
        auto const mode = mode_of(ladder(n, 0, l, cap));
        ASSERT_TRUE(mode.has_value());
        double const exact =
            2 / std::sqrt(l * cap) * std::sin((2 * n - 1) * std::numbers::pi / (2 * (2 * n + 1))) / kTwoPi;
        EXPECT_NEAR(mode->frequency_hz, exact, (n > 80 ? 3e-3 : 1e-6) * exact) << n;
    }
}

TEST(FastestMode, OfWhatDoesNotRingIsNone) {
    EXPECT_FALSE(mode_of(ladder(1, 0, 1e-3, 0)).has_value());
    EXPECT_FALSE(mode_of(ladder(1, 100, 1e-3, 1e-6)).has_value()); // its damping ratio is 1.6
    EXPECT_TRUE(mode_of(ladder(1, 10, 1e-3, 1e-6)).has_value());   // negative control: 0.16
}

TEST(FastestMode, LeavesOutACapacitanceThatMovesNothing) {
    Circuit c = ladder(1, 0.1, 1e-3, 1e-6);
    int const stub = c.add_triple("stub");
    c.add_rl(3, stub, alike(0), alike(1e-6));
    c.add_capacitor(stub, kEarth, alike(1e-9));
    double const var = kTwoPi * 60 * 1e-6 * 100 * 100 / 2;
    auto const mode = mode_of(c, 0.1 * var);
    ASSERT_TRUE(mode.has_value());
    // The correction for losses is made with all capacitances.
    EXPECT_NEAR(mode->frequency_hz, 1 / (kTwoPi * std::sqrt(1e-3 * 1e-6)), 0.005 * mode->frequency_hz);
    EXPECT_GT(mode_of(c)->frequency_hz, 4e6); // negative control
}

/// Two banks with a short tie between them; the second is switched on.
std::string back_to_back(std::string const& more = {}) {
    return "buses: {A: {voltage_v: 13800}, B: {voltage_v: 13800}}\n"
           "sources: {S: {bus: A, r_ohm: 0.05, l_mh: 2}}\n"
           "lines: {L: {from: A, to: B, r_ohm: 0.005, l_mh: 0.02}}\n"
           "shunt_capacitors: {C1: {bus: A, q_kvar: 3000, rated_kv: 13.8}, C2: {bus: B, q_kvar: 3000, rated_kv: 13.8, "
           "state: open}}\n" +
           more;
}

/// Of the two nodes with lossless source and tie: (1/l1 + 1/l2 - w2 c)(1/l2 - w2 c) = 1/l2^2.
double back_to_back_hz() {
    double const cap = 3e6 / (13800.0 * 13800) / (kTwoPi * 60), a = 1 / 2e-3, b = 1 / 2e-5;
    double const half = (a + 2 * b) / 2;
    return std::sqrt((half + std::sqrt(half * half - a * b)) / cap) / kTwoPi;
}

TEST(StepAdvice, NamesTheBanksThatRingAgainstEachOtherAndAStepThatShowsThem) {
    auto const needs = step_needs(network_of(back_to_back()), 0);
    ASSERT_TRUE(needs.has_value());
    ASSERT_TRUE(needs->mode.has_value()); // one bank is open at the start
    EXPECT_NEAR(needs->mode->frequency_hz, back_to_back_hz(), 1e-4 * back_to_back_hz());
    EXPECT_THAT(needs->mode->elements,
                testing::UnorderedElementsAre("line 'L'", "shunt capacitor 'C1'", "shunt capacitor 'C2'"));
    Rational const period{1, 4800};
    auto const advice = step_advice(*needs, 1.0 / 48000, period);
    ASSERT_TRUE(advice.has_value());
    EXPECT_THAT(advice->message, HasSubstr("shunt capacitor 'C1'"));
    Rational const good = resolving_step(*needs, period);
    EXPECT_THAT(advice->remedy, HasSubstr(good.to_string()));
    EXPECT_TRUE((period / good).is_whole());
    EXPECT_GE(1 / (good.to_double() * back_to_back_hz()), kGoodStepsPerPeriod);
    EXPECT_LT(
        1 / ((good.to_double() + 1.0 / 4800 * good.to_double() / (1.0 / 4800 - good.to_double())) * // one part less
             back_to_back_hz()),
        kGoodStepsPerPeriod);
    EXPECT_FALSE(step_advice(*needs, good.to_double(), period).has_value());
}

/// Largest current of phase a in the tie in the first half millisecond after the second bank is switched on at the
/// peak of its voltage.
double inrush(Rational step) {
    TimeBase const base{common_divisor(step, Rational{1, 60})};
    auto const sut = started(network_of(back_to_back()), base, step);
    advance(*sut, SimTime{} + base.nearest(Rational{1, 60}));
    apply(*sut, SwitchBreaker{"C2", true});
    double most = 0;
    for (int k = 1; Rational{k} * step < Rational{1, 2000}; ++k) {
        advance(*sut, SimTime{} + base.nearest(Rational{1, 60}) + base.nearest(step) * k);
        most = std::max(most, std::abs(read(*sut, "line.L.from.i.a")));
    }
    return most;
}

TEST(StepAdvice, WhatItSaysIsLostIsWhatTheSimulationLoses) {
    auto const needs = step_needs(network_of(back_to_back()), 0);
    ASSERT_TRUE(needs.has_value() && needs->mode.has_value());
    double const exact = inrush(Rational{1, 4800 * 400}), hz = needs->mode->frequency_hz;
    auto const lost = [&](Rational step) { return 1 - inrush(step) / exact; };
    auto const said = [&](Rational step) {
        double const x = std::numbers::pi * step.to_double() * hz;
        return 1 - std::pow(1 + x * x, -2);
    };
    Rational const usual{1, 48000}, good = resolving_step(*needs, Rational{1, 4800});
    EXPECT_NEAR(lost(usual), said(usual), 0.05);
    EXPECT_GT(lost(usual), 0.1);
    EXPECT_LT(lost(good), 0.03);
}

TEST(ResolvingStep, OfANetworkWithoutAnOscillationCutsTheFundamental) {
    auto const needs =
        step_needs(network_of("buses: {A: {voltage_v: 400}}\nsources: {S: {bus: A, r_ohm: 0.1, l_mh: 0.1}}\n"
                              "loads: {D: {bus: A, p_kw: 1}}\n"),
                   0);
    ASSERT_TRUE(needs.has_value());
    EXPECT_FALSE(needs->mode.has_value());
    EXPECT_EQ(resolving_step(*needs, Rational(1, 4800)), Rational(1, 14400)); // 200 steps of 60 Hz are 1/12000 s
    EXPECT_FALSE(step_advice(*needs, 1e-3, Rational(1, 4800)).has_value());
}

TEST(ResolvingStep, KeepsWithinTheTravelTimeOfALine) {
    auto const needs = step_needs(
        network_of("buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}\nsources: {S: {bus: A, r_ohm: 0.1, l_mh: 0.1}}\n"
                   "lines: {L: {from: A, to: B, model: bergeron, r_ohm: 0.1, l_mh: 3, c_nf: 30, "
                   "r0_ohm: 0.3, "
                   "l0_mh: 9, c0_nf: 20}}\nloads: {D: {bus: B, p_kw: 1}}\n"),
        0);
    ASSERT_TRUE(needs.has_value());
    EXPECT_NEAR(needs->longest_s, std::sqrt(3e-3 * 30e-9), 1e-12);
    EXPECT_THAT(needs->reason, HasSubstr("line 'L'"));
}

TEST(ResolvingStep, IsNotRuinedByAResonanceThatMovesNothing) {
    // Each alone rings: 100 m of cable at more than 0.2 MHz, the filter of a converter at several kHz.
    auto const with = [](std::string const& more) {
        auto const needs = step_needs(network_of("buses: {A: {voltage_v: 13800}, K: {voltage_v: 13800}}\nsources: {S: "
                                                 "{bus: A, r_ohm: 0.05, l_mh: 2}}\n" +
                                                     more,
                                                 10000),
                                      0);
        EXPECT_TRUE(needs.has_value());
        return resolving_step(*needs, Rational{1, 4800});
    };
    std::string const cable = "lines: {K: {from: A, to: K, r_ohm: 0.02, l_mh: 0.03, c_nf: 30}}\n";
    Rational const usual{1, 14400};
    EXPECT_EQ(with(cable), usual);
    EXPECT_EQ(with(cable + "pv: {P: {bus: K, p_kw: 90}}\n"), usual);
    // Negative control: the same cable with a bank at its end; and no step is shorter than the bound.
    EXPECT_LT(with(cable + "shunt_capacitors: {C: {bus: K, q_kvar: 3000, rated_kv: 13.8}}\n"), usual);
    EXPECT_GE(
        with("lines: {K: {from: A, to: K, r_ohm: 1.0e-6, l_mh: 1.0e-7}}\nshunt_capacitors: {C: {bus: K, q_kvar: 3000, "
             "rated_kv: 13.8}, D: {bus: A, q_kvar: 3000, rated_kv: 13.8}}\n")
            .to_double(),
        0.9 * kShortestAutoStep);
}

} // namespace
} // namespace gridspace::sim::emt

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The solver on circuits with exact solutions.
#include "sim/emt/solver.hpp"
#include "tests/support/allocations.hpp"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

constexpr double kStep = 1.0 / 48000;
constexpr double kOmega = 2 * std::numbers::pi * 60;
PhaseMatrix all(double x) {
    return PhaseMatrix::sequence(x, x);
}

void run(Solver& sut, int steps, double h = kStep) {
    for (int k = 0; k < steps; ++k) {
        auto const ok = sut.advance(sut.t() + h, h);
        ASSERT_TRUE(ok.has_value()) << describe(ok.error());
    }
}

/// Source - switch - series RL - earth; the switch is open at the start.
struct Switched {
    Circuit c;
    int inner{0};
    explicit Switched(double r, double l, bool closed = false) {
        int const outer = c.add_triple("source");
        inner = c.add_triple("load");
        c.sources.push_back({outer, 100, 0, 60, {}, "S"});
        c.switches.push_back({outer, inner, {closed, closed, closed}, {{CurrentTerm::Kind::rl, 0, 1}}, "CB"});
        c.rl.push_back({inner, kEarth, all(r), all(l)});
    }
};

TEST(Solver, ClosingOnAnInductiveLoadFollowsTheExactCurrent) {
    double const r = 1, l = 0.01;
    Solver sut{Switched{r, l}.c, kStep};
    ASSERT_TRUE(sut.start({}).has_value());
    sut.close_switch(0);
    double const z = std::hypot(r, kOmega * l), angle = std::atan2(kOmega * l, r), peak = 100 / z;
    double worst = 0;
    for (int k = 1; k <= 2400; ++k) {
        run(sut, 1);
        double const exact =
            peak * (std::cos(kOmega * sut.t() - angle) - std::cos(-angle) * std::exp(-r / l * sut.t()));
        worst = std::max(worst, std::abs(sut.switch_current(0, 0) - exact) / peak);
    }
    EXPECT_LT(worst, 1e-3); // the two backward Euler half steps at the closing are of first order
    EXPECT_GT(worst, 1e-9); // negative control: it is a numerical solution
}

TEST(Solver, ChargingACapacitorFollowsTheExactVoltage) {
    // Source - switch - r - c: a resistance in an RL branch, the capacitor to earth.
    Circuit c;
    int const outer = c.add_triple("source"), inner = c.add_triple("resistor"), top = c.add_triple("capacitor");
    c.sources.push_back({outer, 100, 0, 60, {}, "S"});
    c.switches.push_back({outer, inner, {false, false, false}, {{CurrentTerm::Kind::rl, 0, 1}}, "CB"});
    double const r = 10, farad = 100e-6;
    c.rl.push_back({inner, top, all(r), {}});
    c.capacitors.push_back({top, kEarth, all(farad)});
    Solver sut{c, kStep};
    ASSERT_TRUE(sut.start({}).has_value());
    sut.close_switch(0);
    std::complex<double> const h = 1.0 / std::complex<double>{1, kOmega * r * farad};
    double worst = 0;
    for (int k = 1; k <= 2400; ++k) {
        run(sut, 1);
        double const exact =
            100 * ((h * std::polar(1.0, kOmega * sut.t())).real() - h.real() * std::exp(-sut.t() / (r * farad)));
        worst = std::max(worst, std::abs(sut.node_voltage(top) - exact) / 100);
    }
    EXPECT_LT(worst, 1e-3);
}

/// Three series RL sections with shunt capacitors, single frequency source; the exact solution by small Runge-Kutta
/// steps.
struct Ladder {
    static constexpr double kR = 0.5, kL = 2e-3, kC = 40e-6, kLoad = 16;
    Circuit c;
    int end{0};
    Ladder() {
        int at = c.add_triple("source");
        c.sources.push_back({at, 100, 0, 60, {}, "S"});
        int const first = c.add_triple("start");
        c.switches.push_back({at, first, {false, false, false}, {{CurrentTerm::Kind::rl, 0, 1}}, "CB"});
        at = first;
        for (int k = 0; k < 3; ++k) {
            int const next = c.add_triple("node");
            c.rl.push_back({at, next, all(kR), all(kL)});
            c.capacitors.push_back({next, kEarth, all(kC)});
            at = next;
        }
        c.rl.push_back({at, kEarth, all(kLoad), {}});
        end = at;
    }
    static void slope(double t, double const* x, double* dx) {
        double v = 100 * std::cos(kOmega * t);
        for (int k = 0; k < 3; ++k) { // x: i1 v1 i2 v2 i3 v3
            double const next = k < 2 ? x[2 * k + 2] : x[5] / kLoad;
            dx[2 * k] = (v - kR * x[2 * k] - x[2 * k + 1]) / kL;
            dx[2 * k + 1] = (x[2 * k] - next) / kC;
            v = x[2 * k + 1];
        }
    }
};

TEST(Solver, ALadderOfThreeSectionsAgreesWithItsExactSolution) {
    Ladder const ladder;
    double const h = 1e-6;
    Solver sut{ladder.c, h};
    ASSERT_TRUE(sut.start({}).has_value());
    sut.close_switch(0);
    double x[6] = {}, worst = 0;
    for (int k = 0; k < 20000; ++k) {
        double const t = k * h;
        double k1[6], k2[6], k3[6], k4[6], y[6];
        Ladder::slope(t, x, k1);
        for (int i = 0; i < 6; ++i)
            y[i] = x[i] + h / 2 * k1[i];
        Ladder::slope(t + h / 2, y, k2);
        for (int i = 0; i < 6; ++i)
            y[i] = x[i] + h / 2 * k2[i];
        Ladder::slope(t + h / 2, y, k3);
        for (int i = 0; i < 6; ++i)
            y[i] = x[i] + h * k3[i];
        Ladder::slope(t + h, y, k4);
        for (int i = 0; i < 6; ++i)
            x[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
        run(sut, 1, h);
        worst = std::max(worst, std::abs(sut.node_voltage(ladder.end) - x[5]) / 100);
    }
    EXPECT_LT(worst, 1e-4);
}

double ladder_after_frequency_step(int per_ms) {
    Ladder ladder;
    ladder.c.switches[0].closed = {true, true, true};
    Solver solver{ladder.c, 1e-3 / per_ms};
    EXPECT_TRUE(solver.start({}).has_value());
    solver.set_source_frequency(0, 75); // the phase is continuous: no discontinuity
    run(solver, 10 * per_ms, 1e-3 / per_ms);
    return solver.node_voltage(ladder.end);
}

TEST(Solver, WithoutSwitchingItConvergesWithTheSquareOfTheStep) {
    double const fine = ladder_after_frequency_step(3200);
    double const coarse = std::abs(ladder_after_frequency_step(50) - fine);
    double const half = std::abs(ladder_after_frequency_step(100) - fine);
    EXPECT_NEAR(coarse / half, 4, 0.2);
}

TEST(Solver, AnInductiveCurrentOpensAtItsZeroWithoutChatter) {
    Switched s{1, 0.01, true};
    s.c.rl.push_back({s.inner, kEarth, all(1000), {}}); // what is left after the opening
    s.c.switches[0].terms.push_back({CurrentTerm::Kind::rl, 1, 1});
    Solver sut{s.c, kStep};
    ASSERT_TRUE(sut.start({}).has_value());
    run(sut, 100);
    sut.open_switch(0);
    int opened = -1;
    for (int k = 0; k < 1600; ++k) {
        run(sut, 1);
        if (opened < 0 && !sut.pole_closed(0, 0)) {
            opened = k;
        }
        if (opened >= 0 && k > opened + 2) {
            // It decays with l / r = 10 us; trapezoidal chatter would alternate for hundreds of steps.
            EXPECT_LT(std::abs(sut.node_voltage(s.inner)), 1.0) << k;
            EXPECT_NEAR(sut.switch_current(0, 0), 0, 1e-9);
        }
    }
    EXPECT_GE(opened, 0);
    EXPECT_TRUE(sut.pole_closed(0, 0) == false && sut.pole_closed(0, 1) == false && sut.pole_closed(0, 2) == false);
}

/// A 400 V feeder (0.05 ohm, 0.2 mH) that carries 10 kW and 5 kvar is opened at a share `f` of a step: the highest
/// voltage of what is left at its end (10 kohm, or 1 nF: both far faster than a step), from the second grid point
/// behind the opening on.
double highest_after_opening_at(double f, bool capacitor) {
    Circuit c;
    int const outer = c.add_triple("source"), inner = c.add_triple("feeder"), load = c.add_triple("load");
    double const peak = 400 * std::sqrt(2.0 / 3);
    c.sources.push_back({outer, peak, 0, 50, {}, "S"});
    c.switches.push_back(
        {inner, load, {true, true, true}, {{CurrentTerm::Kind::rl, 1, 1}, {CurrentTerm::Kind::rl, 2, 1}}, "CB"});
    c.rl.push_back({outer, inner, all(0.05), all(0.2e-3)});
    c.rl.push_back({load, kEarth, all(16), {}});
    c.rl.push_back({load, kEarth, all(0.05), all(32 / (2 * std::numbers::pi * 50))});
    if (capacitor) {
        c.capacitors.push_back({inner, kEarth, all(1e-9)});
    } else {
        c.rl.push_back({inner, kEarth, all(1e4), {}});
    }
    Solver sut{c, kStep};
    EXPECT_TRUE(sut.start({}).has_value());
    run(sut, 4977);
    sut.open_switch(0, {.after_s = f * kStep, .at_once = true});
    run(sut, 2);
    double highest = 0;
    for (int k = 0; k < 2400; ++k) {
        run(sut, 1);
        highest = std::max(highest, std::abs(sut.node_voltage(inner)));
    }
    return highest;
}

TEST(Solver, WhatAnOpeningLeavesBehindDoesNotDependOnWhereInAStepItIs) {
    double const peak = 400 * std::sqrt(2.0 / 3);
    for (bool const capacitor : {false, true}) {
        for (double const f : {0.0, 0.1, 0.5, 0.9, 0.99, 0.999}) {
            EXPECT_NEAR(highest_after_opening_at(f, capacitor), peak, 0.01 * peak) << f << (capacitor ? " C" : " R");
        }
    }
}

/// The source falls to zero: what flows then dies away with l / r = 10 ms, without a zero.
struct Circulating {
    Switched s{1, 0.01, true};
    Solver sut{s.c, kStep};
    double t0{0}, highest{0};
    Circulating() {
        EXPECT_TRUE(sut.start({}).has_value());
        run(sut, 100);
        sut.set_source_amplitude(0, 0);
        t0 = sut.t();
        for (int phase = 0; phase < 3; ++phase) {
            highest = std::max(highest, std::abs(sut.switch_current(0, phase)));
        }
    }
};

TEST(Solver, ACurrentWithoutAZeroKeepsAnIdealPoleClosed) {
    Circulating it;
    it.sut.open_switch(0);
    run(it.sut, 800);
    EXPECT_TRUE(it.sut.pole_closed(0, 0));
    EXPECT_TRUE(it.sut.opening(0));
}

TEST(Solver, APoleInterruptsACurrentThatHasFallenToTheChoppingCurrent) {
    Circulating it;
    it.sut.open_switch(0, {.chop_a = it.highest / 3});
    run(it.sut, 800);
    EXPECT_NEAR(it.sut.opened_at(0) - it.t0, 0.01 * std::log(3.0), kStep / 10); // the last of the three
    for (int phase = 0; phase < 3; ++phase) {
        EXPECT_FALSE(it.sut.pole_closed(0, phase));
        EXPECT_NEAR(it.sut.switch_current(0, phase), 0, 1e-9);
    }
}

TEST(Solver, PolesOpenAtTheirOwnExactCurrentZeros) {
    Switched s{1, 0.01, true};
    Solver sut{s.c, kStep};
    ASSERT_TRUE(sut.start({}).has_value());
    run(sut, 100);
    sut.open_switch(0);
    run(sut, 800);
    // The last of the three zeros after the command at 100 steps: phase b or c, exact to a small part of a step.
    double const angle = std::atan2(kOmega * 0.01, 1);
    double last = 0;
    for (int k = 0; k < 3; ++k) {
        double const shift = angle + k * 2 * std::numbers::pi / 3 +
                             std::numbers::pi / 2; // cos(w t - shift + pi/2) = 0 at w t = shift + n pi
        double t = (shift - std::floor(shift / std::numbers::pi) * std::numbers::pi) / kOmega;
        while (t < 100 * kStep) {
            t += std::numbers::pi / kOmega;
        }
        last = std::max(last, t);
    }
    EXPECT_NEAR(sut.opened_at(0), last, kStep / 100);
}

TEST(Solver, EnergyInEqualsLossesAndWhatIsStored) {
    double const r = 2, l = 0.05;
    Solver sut{Switched{r, l}.c, kStep};
    ASSERT_TRUE(sut.start({}).has_value());
    sut.close_switch(0);
    double delivered = 0, lost = 0, p = 0, q = 0;
    for (int k = 0; k < 4800; ++k) {
        run(sut, 1);
        double power = 0, heat = 0;
        for (int phase = 0; phase < 3; ++phase) {
            double const i = sut.switch_current(0, phase);
            power += sut.node_voltage(3 + phase) * i;
            heat += r * i * i;
        }
        delivered += kStep / 2 * (power + p);
        lost += kStep / 2 * (heat + q);
        p = power;
        q = heat;
    }
    double stored = 0;
    for (int phase = 0; phase < 3; ++phase) {
        stored += l / 2 * std::pow(sut.switch_current(0, phase), 2);
    }
    EXPECT_NEAR(delivered, lost + stored, 2e-3 * delivered);
}

TEST(Solver, AStepAllocatesNothing) {
    Ladder ladder;
    ladder.c.switches[0].closed = {true, true, true};
    Solver sut{ladder.c, kStep};
    ASSERT_TRUE(sut.start({}).has_value());
    run(sut, 10);
    std::size_t const before = allocations();
    bool fine = true;
    for (int k = 0; k < 1000; ++k) {
        fine = sut.advance(sut.t() + kStep, kStep).has_value() && fine;
    }
    EXPECT_EQ(allocations(), before);
    EXPECT_TRUE(fine);
    std::size_t const at_event = allocations();
    sut.open_switch(0);
    run(sut, 800);
    EXPECT_GT(allocations(), at_event); // negative control: events may, and the counter counts
}

TEST(Solver, TwoIdealSourcesThatASwitchJoinsAreAnError) {
    Circuit c;
    int const a = c.add_triple("A"), b = c.add_triple("B");
    c.sources.push_back({a, 100, 0, 60, {}, "A"});
    c.sources.push_back({b, 100, 0, 60, {}, "B"});
    c.switches.push_back({a, b, {true, true, true}, {}, "CB"});
    Solver sut{c, kStep};
    auto const result = sut.start({});
    ASSERT_FALSE(result.has_value());
    EXPECT_THAT(result.error().message, testing::HasSubstr("another ideal source"));
}

} // namespace
} // namespace gridspace::sim::emt

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// ngspice solves the same circuits with its own models, step control and element equations: an outside judge of
// waveforms.
#include "sim/emt/solver.hpp"
#include "tests/integration/ngspice/ngspice_fixture.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <vector>

namespace gridspace::sim::emt {
namespace {

constexpr double kStep = 1.0 / 48000;
PhaseMatrix all(double x) {
    return PhaseMatrix::sequence(x, x);
}

void step(Solver& sut) {
    auto const ok = sut.advance(sut.t() + kStep, kStep);
    ASSERT_TRUE(ok.has_value()) << describe(ok.error());
}

constexpr char const* kSources =
    "Va sa 0 SIN(0 100 60 0 0 90)\nVb sb 0 SIN(0 100 60 0 0 -30)\nVc sc 0 SIN(0 100 60 0 0 210)\n";

TEST_F(Ngspice, AgreesOnACoupledLineWithAnEarthFault) {
    // l own 2 mH, mutual 0.5 mH: l1 = 1.5 mH, l0 = 3 mH; everything starts without current.
    Table const table = judge(
        std::string{kSources} +
            "La sa a1 2m IC=0\nLb sb b1 2m IC=0\nLc sc c1 2m IC=0\nKab La Lb 0.25\nKbc Lb Lc 0.25\nKac La Lc 0.25\n"
            "Ra a1 a2 0.3\nRb b1 b2 0.3\nRc c1 c2 0.3\nLa2 a2 a3 4m IC=0\nRla a3 0 10\nLb2 b2 b3 4m IC=0\nRlb b3 0 10\n"
            "Lc2 c2 c3 4m IC=0\nRlc c3 0 10\nSf a2 f ctl 0 sw OFF\nRf f 0 0.1\nVctl ctl 0 PWL(0 0 20m 0 20.0001m 1)\n"
            ".model sw SW(Ron=1e-6 Roff=1e9 Vt=0.5)\n",
        0.06, "i(Va) i(Vb) v(b2)");
    Circuit c;
    int const s = c.add_triple("s"), begin = c.add_triple("begin"), n = c.add_triple("n");
    c.sources.push_back({s, 100, 0, 60, {}, "S"});
    c.switches.push_back({s, begin, {false, false, false}, {{CurrentTerm::Kind::rl, 0, 1}}, "CB"});
    c.rl.push_back({begin, n, all(0.3), PhaseMatrix::sequence(1.5e-3, 3e-3)});
    c.rl.push_back({n, kEarth, all(10), all(4e-3)});
    c.faults.push_back({n, 0.1, {true, false, false}, true, "f"});
    Solver sut{c, kStep};
    ASSERT_TRUE(sut.start({}).has_value());
    sut.close_switch(0);
    double worst_i = 0, worst_v = 0, largest = 0;
    for (int k = 1; k <= 2870; ++k) {
        step(sut);
        double const ia = -at(table, 1, sut.t()), ib = -at(table, 2, sut.t());
        largest = std::max(largest, std::abs(ia));
        worst_i = std::max({worst_i, std::abs(sut.switch_current(0, 0) - ia), std::abs(sut.switch_current(0, 1) - ib)});
        if (k > 3 && (k < 960 || k > 964)) { // voltages jump at the two switchings
            worst_v = std::max(worst_v, std::abs(sut.node_voltage(n + 1) - at(table, 3, sut.t())));
        }
        if (k == 960) {
            sut.apply_fault(0);
        }
    }
    EXPECT_GT(largest, 60); // the fault was on
    EXPECT_LT(worst_i, 2e-3 * largest);
    EXPECT_LT(worst_v, 1.0);
}

TEST_F(Ngspice, AgreesOnTheRecoveryVoltageAfterOpeningAtCurrentZero) {
    // Source - 1 mH - breaker - 50 mH, with 2 uF and 2 kohm at both sides of the breaker.
    Circuit c;
    int const s = c.add_triple("s"), outer = c.add_triple("outer"), inner = c.add_triple("inner");
    c.sources.push_back({s, 100, 0, 60, {}, "S"});
    c.rl.push_back({s, outer, all(0.1), all(1e-3)});
    c.rl.push_back({inner, kEarth, all(1), all(50e-3)});
    c.rl.push_back({outer, kEarth, all(2000), {}});
    c.rl.push_back({inner, kEarth, all(2000), {}});
    c.capacitors.push_back({outer, kEarth, all(2e-6)});
    c.capacitors.push_back({inner, kEarth, all(2e-6)});
    c.switches.push_back(
        {outer,
         inner,
         {true, true, true},
         {{CurrentTerm::Kind::rl, 1, 1}, {CurrentTerm::Kind::rl, 3, 1}, {CurrentTerm::Kind::capacitor, 1, 1}},
         "CB"});
    double const h = kStep / 8; // the recovery voltage rings at 500 Hz and above
    Solver sut{c, h};
    ASSERT_TRUE(sut.start({}).has_value());
    // The judge starts from the same steady state and opens where this one found the zero of phase a.
    double const v_outer = sut.node_voltage(outer), i_source = sut.current({CurrentTerm::Kind::rl, 0, 1}, 0),
                 i_load = sut.current({CurrentTerm::Kind::rl, 1, 1}, 0);
    std::vector<std::array<double, 3>> got;
    double opened = 0;
    for (int k = 1; k <= 48000 * 8 * 3 / 100; ++k) {
        if (k == 800) {
            sut.open_switch(0);
        }
        bool const before = sut.pole_closed(0, 0);
        ASSERT_TRUE(sut.advance(sut.t() + h, h).has_value());
        if (before && !sut.pole_closed(0, 0)) {
            opened = sut.t();
        }
        got.push_back({sut.t(), sut.node_voltage(outer), sut.node_voltage(inner)});
    }
    ASSERT_GT(opened, 0);
    Table const table = judge(fmt::format("Va sa 0 SIN(0 100 60 0 0 90)\nL1 sa x 1m IC={}\nR1 x o 0.1\nRo o 0 2000\nCo "
                                          "o 0 2u IC={}\nS1 o i ctl 0 sw ON\nL2 i y 50m IC={}\n"
                                          "R2 y 0 1\nRi i 0 2000\nCi i 0 2u IC={}\nVctl ctl 0 PWL(0 1 {} 1 {} "
                                          "0)\n.model sw SW(Ron=1e-5 Roff=1e9 Vt=0.5)\n",
                                          i_source, v_outer, i_load, v_outer, opened - h - 1e-7, opened - h + 1e-7),
                              0.03, "v(o) v(i)");
    double worst = 0, largest = 0;
    for (auto const& [t, o, i] : got) {
        double const across = at(table, 1, t) - at(table, 2, t);
        largest = std::max(largest, std::abs(across));
        worst = std::max(worst, std::abs(o - i - across));
    }
    EXPECT_GT(largest, 150); // the load side swings against the source
    EXPECT_LT(worst, 0.03 * largest);
}

TEST_F(Ngspice, AgreesOnTheInrushOfASaturatingCore) {
    double const l = 5, l_air = 0.05, knee = 0.32;
    Table const table = judge(
        fmt::format("Va sa 0 SIN(0 100 60)\nR1 sa b 0.5\nL1 b n 2m IC=0\nBf f 0 I = -v(n)\nCf f 0 1 IC=0\nRf f 0 1e12\n"
                    "Bc n 0 I = abs(v(f)) < {2} ? v(f)/{0} : sgn(v(f))*({2}/{0} + (abs(v(f))-{2})/{1})\n",
                    l, l_air, knee),
        0.1, "i(Va)");
    Circuit c;
    int const s = c.add_triple("s"), begin = c.add_triple("begin"), n = c.add_triple("n");
    c.sources.push_back({s, 100, -1.5707963267948966, 60, {}, "S"}); // phase a is a sine: the worst instant
    c.switches.push_back({s, begin, {false, false, false}, {{CurrentTerm::Kind::rl, 0, 1}}, "CB"});
    c.rl.push_back({begin, n, all(0.5), all(2e-3)});
    for (int k = 0; k < 3; ++k) {
        c.cores.push_back({{n + k, kEarth, kEarth, kEarth}, {1, 0, 0, 0}, l, l_air, knee});
    }
    Solver sut{c, kStep};
    ASSERT_TRUE(sut.start({}).has_value());
    sut.close_switch(0);
    double worst = 0, largest = 0;
    for (int k = 1; k <= 4790; ++k) {
        step(sut);
        double const judge_a = -at(table, 1, sut.t());
        largest = std::max(largest, std::abs(judge_a));
        worst = std::max(worst, std::abs(sut.switch_current(0, 0) - judge_a));
    }
    EXPECT_GT(largest, 3); // the linear core would draw 0.1 A
    EXPECT_LT(worst, 0.01 * largest);
}

} // namespace
} // namespace gridspace::sim::emt

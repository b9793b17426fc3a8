// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/power_flow.hpp"
#include "sim/runtime/tap_changing_engine.hpp"
#include "tests/unit/components/element_fixture.hpp"

#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

/// A transformer that holds the voltage of a load on its secondary side.
namespace gridspace::sim {
namespace {

TimeBase const kBase{Rational{1, 12000}};

std::string changer(std::string const& more = "") {
    return "tap_changer: {bandwidth_percent: 2, delay_s: 0.5, next_delay_s: 0.2, step_percent: 1.25" + more + "}";
}

config::Diagnostics read_transformer(std::string const& tap_changer, Network& out, std::string const& more = "") {
    std::string const text = fmt::format(
        "gridspace_network: 1\nname: t\nbase: {{frequency_hz: 60, power_kva: 1000}}\n"
        "buses: {{A: {{voltage_v: 10000}}, B: {{voltage_v: 400}}}}\nsources: {{S: {{bus: A, r_ohm: 0.5, l_mh: 5}}}}\n"
        "transformers: {{T: {{from: A, to: B, rating_kva: 1000, r_percent: 1, x_percent: 6, {}{}}}}}\n"
        "loads: {{L: {{bus: B, p_kw: 100, power_factor: 0.9, model: constant_impedance}}}}\n",
        tap_changer, more);
    return read_text(text, out);
}

Network network(std::string const& tap_changer) {
    Network n;
    auto const diagnostics = read_transformer(tap_changer, n);
    EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    return n;
}

class Grid {
  public:
    Grid(std::string const& solver, Network const& n) {
        engine_ = with_tap_changers(make(solver, n, kBase), n, kBase);
        must(engine_->initialise());
    }
    void set(std::string const& path, double value) { must(engine_->apply(SetParameter{path, value})); }
    [[nodiscard]] bool refuses(std::string const& path, double value) {
        return !engine_->apply(SetParameter{path, value}).has_value();
    }
    void until(double s) {
        constexpr double kStepS = 0.005;
        while (t_ < s - 1e-9) {
            t_ += kStepS;
            must(engine_->advance(SimTime{} + SimSpan{std::llround(t_ * 12000)}));
        }
    }
    [[nodiscard]] double position() const { return read(*engine_, "transformer.T.tap_position"); }
    [[nodiscard]] double read_signal(std::string const& name) const { return read(*engine_, name); }
    [[nodiscard]] double v() const { return read(*engine_, "bus.B.v_pu"); }

  private:
    std::unique_ptr<Engine> engine_;
    double t_{0};
};

class TapChangerIn : public testing::TestWithParam<char const*> {};
INSTANTIATE_TEST_SUITE_P(Solver, TapChangerIn, testing::Values("phasor", "emt"));

TEST_P(TapChangerIn, BringsTheVoltageBackIntoItsBandStepByStep) {
    Network n = network(changer());
    Grid sut{GetParam(), n};
    sut.until(1);
    EXPECT_EQ(sut.position(), 0);
    sut.set("loads.L.demand_pu", 7); // 700 kW: about 4 % lower
    sut.until(1.48);
    EXPECT_LT(sut.v(), 0.99);
    EXPECT_EQ(sut.position(), 0) << "the first step after 0.5 s";
    sut.until(1.52);
    EXPECT_EQ(sut.position(), 1);
    sut.until(1.68);
    EXPECT_EQ(sut.position(), 1) << "the next after 0.2 s more";
    sut.until(1.72);
    EXPECT_EQ(sut.position(), 2);
    sut.until(5);
    EXPECT_GT(sut.v(), 0.99);
    EXPECT_LT(sut.v(), 1.01);
    double const settled = sut.position();
    // The power flow with that position and load finds the same voltage.
    Network other = network(changer(fmt::format(", position: {}", settled)));
    other.loads[0].demand_pu = 7;
    auto const flow = solve_power_flow(other, SwitchState{other});
    ASSERT_TRUE(flow.has_value());
    EXPECT_NEAR(sut.v(), std::abs(flow->buses[1].v), 1e-4);
    sut.set("loads.L.demand_pu", 0.5);
    sut.until(12);
    EXPECT_LT(sut.position(), settled) << "and down again";
    EXPECT_NEAR(sut.v(), 1, 0.0101);
}

TEST_P(TapChangerIn, StaysAtItsLimitAndWhereTheVoltageIsGone) {
    Grid limited{GetParam(), network(changer(", highest: 1"))};
    limited.set("loads.L.demand_pu", 7);
    limited.until(4);
    EXPECT_EQ(limited.position(), 1);
    Grid dark{GetParam(), network(changer())};
    dark.set("sources.S.voltage_pu", 0.5);
    dark.until(4);
    EXPECT_EQ(dark.position(), 0);
}

TEST_P(TapChangerIn, NobodyElseSetsItsRatio) {
    Grid sut{GetParam(), network(changer())}, without{GetParam(), network("")};
    EXPECT_TRUE(sut.refuses("transformers.T.tap_ratio", 1.05));
    EXPECT_FALSE(without.refuses("transformers.T.tap_ratio", 1.05));
}

TEST(TapRegulator, ADeviationThatEndsBeginsItsTimeAnew) {
    TapChanger data;
    data.delay_s = 10;
    TapRegulator sut{data, false};
    EXPECT_FALSE(sut.step(0.95, 9));
    EXPECT_FALSE(sut.step(1.0, 1));
    EXPECT_FALSE(sut.step(0.95, 9));
    EXPECT_TRUE(sut.step(0.95, 1));
    EXPECT_EQ(sut.position(), 1);
    TapRegulator reversed{data, true};
    EXPECT_TRUE(reversed.step(0.95, 10));
    EXPECT_EQ(reversed.position(), -1) << "its bus is at `from`";
}

/// A load centre behind 0.004 + j0.008 ohm; with this PT ratio 120 V are the nominal 230.9 V, and the CT has 1200 A.
Network load_centre(std::string const& compensation) {
    Network n;
    std::string const text =
        "gridspace_network: 1\nname: t\nbase: {frequency_hz: 60, power_kva: 1000}\n"
        "buses: {A: {voltage_v: 10000}, B: {voltage_v: 400}, C: {voltage_v: 400}}\n"
        "sources: {S: {bus: A, r_ohm: 0.5, l_mh: 5}}\nlines: {L: {from: B, to: C, r_ohm: 0.004, x_ohm: 0.008}}\n"
        "transformers: {T: {from: A, to: B, rating_kva: 1000, r_percent: 1, x_percent: 6, " +
        changer(compensation) + "}}\nloads: {L1: {bus: C, p_kw: 500, power_factor: 0.9, model: constant_impedance}}\n";
    auto const diagnostics = read_text(text, n);
    EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    return n;
}

TEST_P(TapChangerIn, CompensatesTheDropToALoadCentre) {
    double const pt_ratio = 400 / std::sqrt(3.0) / 120, ct_a = 1200;
    std::string const settings = fmt::format(", compensation: {{r_v: {}, x_v: {}, ct_a: 1200}}",
                                             0.004 * ct_a / pt_ratio, 0.008 * ct_a / pt_ratio);
    Grid sut{GetParam(), load_centre(settings)}, without{GetParam(), load_centre("")};
    sut.until(8);
    without.until(8);
    EXPECT_NEAR(sut.read_signal("bus.C.v_pu"), 1, 0.0101);
    EXPECT_GT(sut.v(), 1.01) << "more than the band at its own terminals";
    EXPECT_NEAR(without.v(), 1, 0.0101);
    EXPECT_LT(without.read_signal("bus.C.v_pu"), 0.985);
    LineDropCompensation const by_hand{0.004 * ct_a / pt_ratio, 0.008 * ct_a / pt_ratio, ct_a};
    std::complex<double> const kva{-sut.read_signal("transformer.T.to.p_kw"),
                                   -sut.read_signal("transformer.T.to.q_kvar")};
    EXPECT_NEAR(by_hand.compensated_pu(sut.v(), kva, 400), sut.read_signal("bus.C.v_pu"), 2e-6);
}

TEST(LineDropCompensation, PublishedVoltagesAndCurrentsOfTheThirteenBusFeederAreInTheBandOfItsRegulators) {
    // IEEE PES test feeder of 13 buses: bus RG60 in p.u. of 2401.8 V and degrees; amperes; 122 V +- 1 V, PT ratio 20.
    double const nominal_v = 4160, base_v = nominal_v / std::sqrt(3.0) / 20;
    LineDropCompensation const sut{3, 9, 700, base_v};
    struct Phase {
        double v_pu, v_deg, i_a, i_deg;
    };
    for (Phase const& p :
         {Phase{1.0625, 0, 558.40, -28.58}, {1.0500, -120, 414.87, -140.91}, {1.0687, 120, 586.60, 93.59}}) {
        double const kva = std::sqrt(3.0) * p.v_pu * nominal_v * p.i_a / 1e3;
        double const v =
            sut.compensated_pu(p.v_pu, std::polar(kva, (p.v_deg - p.i_deg) * std::numbers::pi / 180), nominal_v);
        EXPECT_NEAR(v * base_v, 122, 1) << p.v_deg;
    }
    LineDropCompensation const none{0, 0, 700, base_v};
    EXPECT_GT(none.compensated_pu(1.0625, {1000, 500}, nominal_v) * base_v, 127) << "without it they are not";
}

TEST(TapChanger, WhatCannotWorkIsAnError) {
    Network n;
    EXPECT_EQ(read_transformer(changer(", position: 9"), n).errors(), 1);
    EXPECT_EQ(read_transformer("tap_changer: {bandwidth_percent: 1, step_percent: 1.25}", n).errors(), 1)
        << "it would hunt";
    EXPECT_EQ(read_transformer(changer(", bus: Z"), n).errors(), 1);
    EXPECT_EQ(read_transformer(changer(", bus: A, compensation: {r_v: 3, ct_a: 700}"), n).errors(), 1);
    EXPECT_EQ(read_transformer(changer(", compensation: {r_v: 3, x_v: 9}"), n).errors(), 1) << "no ct_a";
    EXPECT_EQ(read_transformer(changer(), n, ", magnetising_percent: 1, saturation: {knee_pu: 1.2}").errors(), 1);
}

} // namespace
} // namespace gridspace::sim

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/components/element_fixture.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

/// The test circuit of IEEE 1547.1 for unintentional islanding: an inverter, a resonant load that takes just what it
/// gives, and a grid that goes away.
namespace gridspace::sim {
namespace {

constexpr std::int64_t kIslandStepsPerS = 48000;

/// `quality`: of the load, sqrt(Q_L Q_C) / P.
class ResonantIsland {
  public:
    explicit ResonantIsland(std::string const& anti_islanding, double quality = 1, std::string const& solver = "emt") {
        Network n;
        std::string const text = fmt::format(
            "gridspace_network: 1\nname: t\nbase: {{frequency_hz: 60, power_kva: 100}}\n"
            "buses: {{A: {{voltage_v: 400}}, B: {{voltage_v: 400}}}}\nsources: {{S: {{bus: A, r_ohm: 0.01, l_mh: "
            "0.05}}}}\n"
            "lines: {{L: {{from: A, to: B, r_ohm: 0.01, l_mh: 0.02}}}}\nbreaker_types: {{b: {{}}}}\n"
            "breakers: {{K: {{line: L, end: from, type: b}}}}\n"
            "pv: {{P: {{bus: B, p_kw: 20, rating_kva: 25, ride_through: {{category: III{}}}}}}}\n"
            "loads: {{RL: {{bus: B, p_kw: 20, q_kvar: {}, model: constant_impedance}}}}\n"
            "shunt_capacitors: {{C: {{bus: B, q_kvar: {}, rated_kv: 0.4}}}}\n",
            anti_islanding.empty() ? "" : ", anti_islanding: " + anti_islanding, 20 * quality, 20 * quality);
        auto const diagnostics = read_text(text, n);
        EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
        engine_ = make(solver, n, TimeBase{Rational{1, kIslandStepsPerS}});
        must(engine_->initialise());
    }
    void until(double s) { must(engine_->advance({std::llround(s * kIslandStepsPerS)})); }
    void lose_grid(double s) {
        until(s);
        must(engine_->apply(SwitchBreaker{"K", false}));
    }
    [[nodiscard]] double hz() const { return read(*engine_, "bus.B.frequency_hz"); }
    [[nodiscard]] double v() const { return read(*engine_, "bus.B.v_pu"); }
    [[nodiscard]] double share() const { return read(*engine_, "pv.P.in_service_share"); }

  private:
    std::unique_ptr<Engine> engine_;
};

TEST(AntiIslanding, WithoutItAMatchedIslandLivesOn) {
    ResonantIsland sut{""};
    sut.lose_grid(0.5);
    sut.until(5);
    EXPECT_EQ(sut.share(), 1);
    EXPECT_NEAR(sut.v(), 1, 0.02);
    EXPECT_NEAR(sut.hz(), 60, 0.1);
}

TEST(AntiIslanding, TheFrequencyShiftLeavesItWithinTwoSeconds) {
    for (double const quality : {0.5, 1.0, 2.0}) { // K of 0.05 leaves those below 2.36
        ResonantIsland sut{"{}", quality};
        sut.lose_grid(0.5);
        sut.until(2.5); // IEEE 1547-2018, 8.1.1
        EXPECT_EQ(sut.share(), 0) << quality;
        sut.until(2.7);
        EXPECT_LT(sut.v(), 0.05) << quality;
    }
}

TEST(AntiIslanding, StaysWithTheGrid) {
    ResonantIsland sut{"{}"};
    sut.until(5);
    EXPECT_EQ(sut.share(), 1);
    EXPECT_NEAR(sut.hz(), 60, 1e-3);
    EXPECT_NEAR(sut.v(), 1, 0.02);
}

/// Where the angle of the load, atan Q (f / f0 - f0 / f), is that of the shift; by bisection. The converter takes back
/// what its filter of 25 var gives at 60 Hz, and reactances are those of the trapezoidal rule.
double island_hz(double quality, double chopping, double gain) {
    double const pi = std::numbers::pi, h = 1.0 / static_cast<double>(kIslandStepsPerS);
    double low = 60, high = 62;
    for (int i = 0; i < 60; ++i) {
        double const f = (low + high) / 2, seen = std::tan(pi * f * h) / (pi * h) / 60,
                     nominal = std::tan(pi * 60 * h) / (pi * 60 * h);
        double const load = std::atan(quality * (seen - 1 / seen) + 0.025 / 20 * (seen - nominal));
        (load < pi / 2 * (chopping + gain * (f - 60)) ? low : high) = f;
    }
    return low;
}

TEST(AntiIslanding, BelowTheGainOfTheNonDetectionZoneTheIslandKeepsTheFrequencyOfTheTwoAngles) {
    for (double const gain : {0.0, 0.010, 0.018}) {
        ResonantIsland sut{fmt::format("{{chopping_pu: 0.003, gain_per_hz: {}}}", gain)};
        sut.lose_grid(0.5);
        sut.until(8);
        EXPECT_EQ(sut.share(), 1) << gain;
        double const nearer = 1 - gain * std::numbers::pi * 60 / 4; // the feedback makes small differences larger
        EXPECT_NEAR(sut.hz(), island_hz(1, 0.003, gain), 1e-4 / nearer) << gain;
    }
    ResonantIsland above{"{chopping_pu: 0.003, gain_per_hz: 0.025}"}; // 4 / (pi 60) = 0.0212
    above.lose_grid(0.5);
    above.until(8);
    EXPECT_EQ(above.share(), 0);
}

TEST(AntiIslanding, WhatCannotBeIsAnError) {
    Network n;
    auto const wrong = [&n](std::string const& keys) {
        return read_text(fmt::format(
                             "gridspace_network: 1\nname: t\nbase: {{frequency_hz: 60, power_kva: 100}}\n"
                             "buses: {{A: {{voltage_v: 400}}}}\nsources: {{S: {{bus: A, l_mh: 0.05}}}}\n"
                             "pv: {{P: {{bus: A, p_kw: 20, rating_kva: 25, ride_through: {{anti_islanding: {}}}}}}}\n",
                             keys),
                         n)
            .errors();
    };
    EXPECT_EQ(wrong("{}"), 0);
    EXPECT_EQ(wrong("{chopping_pu: 0.6}"), 1);
    EXPECT_EQ(wrong("{gain_per_hz: -0.1}"), 1);
}

} // namespace
} // namespace gridspace::sim

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A machine alone with a load, whose governor is told what to hold and how: f = f_set + droop f0 (p_set - p_mechanical)
// / rating at rest.
#include "common/config/yaml.hpp"
#include "sim/actions/action_table.hpp"
#include "sim/emt/emt_engine.hpp"
#include "sim/network/network_config.hpp"
#include "sim/phasor/phasor_engine.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace gridspace::sim {
namespace {

constexpr double kNominal = 50, kDroop = 0.04, kRating = 100;
constexpr int kStepsPerSecond = 2000;

/// `governor`: what it has beside droop and lags.
Network island(std::string_view governor) {
    std::string const text = fmt::format(R"(gridspace_network: 1
name: island
base: {{frequency_hz: 50, power_kva: 100}}
buses: {{A: {{voltage_v: 400}}, B: {{voltage_v: 400}}}}
lines: {{L: {{from: A, to: B, r_ohm: 0.001, l_mh: 0.01}}}}
machine_types: {{unit: {{model: classical, constants_pu: {{xd1: 0.1, x0: 0.1}}, inertia_h_s: 2, {}}}}}
machines: {{M: {{bus: A, type: unit, rating_kva: 100, p_kw: 40, voltage_setpoint_pu: 1}}}}
loads: {{D: {{bus: B, p_kw: 40, model: constant_impedance}}}}
)",
                                         governor);
    config::Diagnostics diagnostics;
    auto out = read_network(*config::parse_yaml(text, config::make_source("n.yaml", text), diagnostics), diagnostics);
    EXPECT_TRUE(out.has_value()) << diagnostics.render();
    return std::move(*out);
}

struct Governors : testing::TestWithParam<bool> {
    void start(std::string_view governor) {
        TimeBase const base{Rational{1, kStepsPerSecond}};
        auto made = GetParam() ? emt::make_emt_engine(island(governor), {base, {1}, 0})
                               : phasor::make_phasor_engine(island(governor), {.time_base = base});
        ASSERT_TRUE(made.has_value()) << made.error().message;
        sut = std::move(*made);
        ASSERT_TRUE(sut->initialise().has_value());
    }
    void tell(Action const& action) {
        auto const ok = sut->apply(action);
        ASSERT_TRUE(ok.has_value()) << ok.error().message;
    }
    /// The mean of the last tenth of a second of `seconds` more.
    std::map<std::string, double> after(int seconds) {
        std::map<std::string, double> out;
        constexpr int kMean = kStepsPerSecond / 10;
        std::int64_t const end = now + std::int64_t{seconds} * kStepsPerSecond;
        while (now < end) {
            EXPECT_TRUE(sut->advance({++now}).has_value());
            for (char const* name : {"frequency_hz", "p_kw", "mechanical_kw"}) {
                out[name] +=
                    end - now < kMean ? sut->value(sut->find_signal(fmt::format("machine.M.{}", name))) / kMean : 0;
            }
        }
        return out;
    }
    static double by_droop(double held_hz, double p_kw) { return held_hz + kDroop * kNominal * (40 - p_kw) / kRating; }

    std::unique_ptr<Engine> sut;
    std::int64_t now{0};
};
INSTANTIATE_TEST_SUITE_P(, Governors, testing::Bool(),
                         [](auto const& param) { return param.param ? "Waveforms" : "Phasors"; });

constexpr std::string_view kOnlyDroop = "governor: {droop_percent: 4, tg_s: 0.05, tt_s: 0.1}";
constexpr std::string_view kWithIntegral = "governor: {droop_percent: 4, tg_s: 0.05, tt_s: 0.1, integral_ki: 25}";

TEST_P(Governors, TheFrequencyFollowsTheSetpointByTheDroop) {
    start(kOnlyDroop);
    tell(SetParameter{"machines.M.frequency_setpoint_hz", 50.2});
    tell(SetParameter{"loads.D.demand_pu", 1.5});
    auto const m = after(8);
    EXPECT_GT(m.at("p_kw"), 55);
    EXPECT_NEAR(m.at("frequency_hz"), by_droop(50.2, m.at("mechanical_kw")), 2e-3);
}

TEST_P(Governors, AnIntegralBringsTheFrequencyToTheSetpoint) {
    start(kWithIntegral);
    tell(SetParameter{"machines.M.frequency_setpoint_hz", 50.2});
    tell(SetParameter{"loads.D.demand_pu", 1.5});
    EXPECT_NEAR(after(10).at("frequency_hz"), 50.2, 2e-3);
}

TEST_P(Governors, InTheModeDroopTheIntegralRestsAndInIsochronousItGoesOn) {
    start(kWithIntegral);
    tell(SetMode{"M", "droop"});
    tell(SetParameter{"loads.D.demand_pu", 1.5});
    auto const droop = after(8);
    EXPECT_NEAR(droop.at("frequency_hz"), by_droop(kNominal, droop.at("mechanical_kw")), 2e-3);
    EXPECT_LT(droop.at("frequency_hz"), 49.7);
    tell(SetMode{"M", "isochronous"});
    EXPECT_NEAR(after(10).at("frequency_hz"), kNominal, 2e-3);
}

TEST_P(Governors, InTheModeFixedPowerTheSpeedMovesNothing) {
    start(kOnlyDroop);
    tell(SetMode{"M", "fixed_power"});
    tell(SetParameter{"loads.D.demand_pu", 1.1});
    auto const m = after(2);
    EXPECT_LT(m.at("frequency_hz"), 49.5);
    EXPECT_NEAR(m.at("mechanical_kw"), 40, 0.2); // what the losses take was there at the start
}

TEST_P(Governors, WhatAMachineHasNotIsRefusedWithTheReason) {
    start(kOnlyDroop);
    auto const why = [&](SetMode const& action) {
        auto const refused = sut->apply(action);
        return refused ? "" : refused.error().message + "; " + refused.error().remedy;
    };
    EXPECT_EQ(why({"M", "isochronous"}),
              "the mode of 'M' cannot be 'isochronous': its governor has no integral; give it an `integral_ki`");
    EXPECT_EQ(why({"M", "drop"}), "the mode of 'M' cannot be 'drop'; did you mean 'droop'?");
    EXPECT_EQ(why({"D", "droop"}),
              "the mode of 'D' cannot be 'droop': there is no such element with modes; there are: M");
    start("damping_pu: 1");
    EXPECT_EQ(why({"M", "droop"}),
              "the mode of 'M' cannot be 'droop': this machine has no governor; give it or its type a `governor`");
    EXPECT_FALSE(sut->apply(SetParameter{"machines.M.frequency_setpoint_hz", 50}).has_value());
}

} // namespace
} // namespace gridspace::sim

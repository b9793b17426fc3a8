// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/network.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace gridspace::sim {
namespace {

TEST(Profile, IsLinearBetweenPointsAndConstantOutside) {
    Profile sut;
    sut.hours = {1, 2, 4};
    sut.values = {10, 20, 0};
    EXPECT_DOUBLE_EQ(sut.value_at(0, 9), 10);
    EXPECT_DOUBLE_EQ(sut.value_at(1.5, 9), 15);
    EXPECT_DOUBLE_EQ(sut.value_at(3, 9), 10);
    EXPECT_DOUBLE_EQ(sut.value_at(9, 9), 0);
}

TEST(Profile, TheSunFollowsTheHourOfTheDay) {
    Profile sut;
    sut.time = Profile::Time::hour_of_day;
    sut.half_sine = Profile::HalfSine{6, 20, 1.2};
    EXPECT_DOUBLE_EQ(sut.value_at(4, 9), 1); // 13:00, the middle of the day
    EXPECT_NEAR(sut.value_at(0, 9), std::pow(std::sin(std::numbers::pi * 3 / 14), 1.2), 1e-12);
    EXPECT_DOUBLE_EQ(sut.value_at(12, 9), 0);   // 21:00
    EXPECT_NEAR(sut.value_at(28, 9), 1, 1e-12); // 13:00 of the next day
}

TEST(Profile, CloudsMultiply) {
    Profile sut;
    sut.hours = {0};
    sut.values = {2};
    sut.clouds = {{3, 50, 0.2}};
    EXPECT_DOUBLE_EQ(sut.value_at(3, 0), 1);
    EXPECT_NEAR(sut.value_at(3.2, 0), 2 * (1 - 0.5 * std::exp(-1.0)), 1e-12);
}

TEST(LineTotals, ComeFromATypeAndALengthOrFromTotals) {
    Network network;
    network.frequency_hz = 60;
    LineType type;
    type.name.name = "cable";
    type.r_ohm_per_km = 0.32;
    type.x_ohm_per_km = 0.11;
    network.line_types.push_back(type);
    Line by_type;
    by_type.type.name = "cable";
    by_type.length_km = 0.5;
    Line by_totals;
    by_totals.r_ohm = 0.16;
    by_totals.l_mh = 0.055 / (2 * std::numbers::pi * 60) * 1e3;
    by_totals.r0_ohm = 0.3;
    NetworkAround const around{network};
    EXPECT_DOUBLE_EQ(by_type.totals(around).r_ohm, 0.16);
    EXPECT_DOUBLE_EQ(by_type.totals(around).l_h, by_totals.totals(around).l_h);
    EXPECT_DOUBLE_EQ(by_type.totals(around).r0_ohm, 0.16); // zero sequence as positive when not given
    EXPECT_DOUBLE_EQ(by_totals.totals(around).r0_ohm, 0.3);
}

TEST(Load, ReactivePowerComesFromThePowerFactor) {
    Load load;
    load.p_kw = 9.5;
    load.power_factor = 0.95;
    EXPECT_NEAR(load.nominal_q_kvar(), 10 * std::sqrt(1 - 0.95 * 0.95), 1e-12);
    load.model = LoadModel::dc_resistive;
    EXPECT_EQ(load.nominal_q_kvar(), 0);
}

} // namespace
} // namespace gridspace::sim

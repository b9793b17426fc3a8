// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/ev/ev_logic.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace gridspace::agents {
namespace {

TEST(EvLogic, AsksForTheCurrentThatReachesTheTargetInTime) {
    EvParams const sut{.requested_h = 4};
    // Eq. (1): 0.57 x 24 kWh in 4 h at 360 V
    EXPECT_NEAR(requested_current_a(sut, 23, 0), 0.57 * 24000 / (4 * 360), 1e-12);
    EXPECT_NEAR(requested_current_a(sut, 60, 3), 0.20 * 24000 / (1 * 360), 1e-12);
}

TEST(EvLogic, NeverAsksForMoreThanTheRatedCurrent) {
    EvParams const sut{.requested_h = 1};
    EXPECT_EQ(requested_current_a(sut, 10, 0), 15);
}

TEST(EvLogic, TheRemainingTimeHasALowerLimit) {
    EvParams const sut{.rated_current_a = 1000, .requested_h = 4};
    EXPECT_NEAR(requested_current_a(sut, 79, 3.99), 0.01 * 24000 / (0.1 * 360), 1e-9);
    EXPECT_NEAR(requested_current_a(sut, 79, 9), 0.01 * 24000 / (0.1 * 360), 1e-9);
}

TEST(EvLogic, AFinishedEvAsksForNothing) {
    EvParams const sut;
    EXPECT_EQ(requested_current_a(sut, 80, 1), 0);
    EXPECT_EQ(requested_current_a(sut, 81, 1), 0);
}

TEST(EvLogic, AMeasurementThatIsNotANumberAsksForNothing) {
    EXPECT_EQ(requested_current_a(EvParams{}, std::nan(""), 1), 0);
}

TEST(EvLogic, AsPrintedTheTimeIsFixed) {
    EvParams const sut{.requested_h = 4, .time_base = EvParams::TimeBase::fixed};
    EXPECT_EQ(requested_current_a(sut, 50, 0), requested_current_a(sut, 50, 3));
}

} // namespace
} // namespace gridspace::agents

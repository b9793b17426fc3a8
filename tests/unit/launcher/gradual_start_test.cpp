// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/gradual_start.hpp"

#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

using namespace std::chrono_literals;

class AGradualStart : public ::testing::Test {
  protected:
    GradualStart::Clock::time_point now_{1h};
    GradualStart sut_{now_};
};

TEST_F(AGradualStart, LetsThirtyTwoLookAtATime) {
    EXPECT_TRUE(sut_.has_room(31, 0, now_));
    EXPECT_FALSE(sut_.has_room(32, 0, now_));
}

TEST_F(AGradualStart, GoesOnWhenSomebodyIsMatched) {
    for (std::size_t matched = 1; matched < 200; ++matched) {
        now_ += 990ms;
        EXPECT_FALSE(sut_.has_room(32, matched, now_)) << "it advances, so nobody else is needed";
        EXPECT_TRUE(sut_.has_room(31, matched, now_));
    }
}

TEST_F(AGradualStart, LetsMoreBeginWhenNobodyGetsOnForASecond) {
    EXPECT_FALSE(sut_.has_room(32, 0, now_ + 999ms));
    EXPECT_TRUE(sut_.has_room(32, 0, now_ + 1s));
    EXPECT_FALSE(sut_.has_room(64, 0, now_ + 1999ms));
    EXPECT_TRUE(sut_.has_room(64, 0, now_ + 2s));
}

} // namespace
} // namespace gridspace::launcher

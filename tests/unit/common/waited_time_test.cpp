// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/waited_time.hpp"

#include <gtest/gtest.h>

namespace gridspace {
namespace {

using namespace std::chrono_literals;

TEST(WaitedTime, IsTheSumOfWhatIsBetweenTheLooks) {
    WaitedTime::Clock::time_point now{};
    WaitedTime sut{now};
    for (int i = 0; i < 9; ++i) {
        sut.look(now += 300ms);
    }
    EXPECT_DOUBLE_EQ(sut.look(now += 300ms).count(), 3.0);
    sut.restart(now);
    EXPECT_DOUBLE_EQ(sut.look(now + 100ms).count(), 0.1);
}

TEST(WaitedTime, OfAPauseOfTheWholeMachineHalfASecondCounts) {
    WaitedTime::Clock::time_point now{};
    WaitedTime sut{now};
    EXPECT_DOUBLE_EQ(sut.look(now += 200ms).count(), 0.2);
    EXPECT_DOUBLE_EQ(sut.look(now += 1h).count(), 0.7);
    EXPECT_DOUBLE_EQ(sut.look(now += 200ms).count(), 0.9);
}

} // namespace
} // namespace gridspace

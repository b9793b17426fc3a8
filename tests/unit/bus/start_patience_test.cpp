// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/start_patience.hpp"

#include <gtest/gtest.h>

namespace gridspace::bus {
namespace {

using namespace std::chrono_literals;

class AStart : public ::testing::Test {
  protected:
    /// Looks every 100 ms for so long; true when the patience was over on the way.
    bool ends_within(std::chrono::milliseconds time, std::size_t present) {
        for (auto const until = now_ + time; now_ < until;) {
            if (sut_.over(present, now_ += 100ms)) {
                return true;
            }
        }
        return false;
    }
    StartPatience::Clock::time_point now_{};
    StartPatience sut_{30, now_};
};

TEST_F(AStart, LastsAsLongAsMoreAndMoreIsThere) {
    for (std::size_t present = 1; present < 100; ++present) {
        ASSERT_FALSE(ends_within(29s, present)) << present;
    }
    EXPECT_TRUE(ends_within(31s, 99));
}

TEST_F(AStart, IsNotProlongedByWhatGoesAndComesBack) {
    ASSERT_FALSE(ends_within(10s, 5));
    ASSERT_FALSE(ends_within(10s, 4));
    EXPECT_TRUE(ends_within(15s, 5));
}

TEST_F(AStart, DoesNotCountWhatTheMachineDidNotRun) {
    for (int i = 0; i < 50; ++i) {
        ASSERT_FALSE(sut_.over(0, now_ += 1min)) << "of each pause half a second";
    }
}

TEST_F(AStart, HasNoEndWithoutADeadline) {
    StartPatience sut{0, now_};
    EXPECT_FALSE(sut.over(0, now_ + 1h));
}

} // namespace
} // namespace gridspace::bus

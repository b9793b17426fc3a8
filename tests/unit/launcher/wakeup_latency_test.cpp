// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/doctor/wakeup_latency.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>

namespace gridspace::launcher {
namespace {

TEST(WakeupLatency, EachWayToWaitGivesEveryWakeUpOrSaysWhatIsNotPermitted) {
    for (auto const& [waiting, key, name] : kWaysToWait) {
        auto const found = measure_wakeups(waiting, std::chrono::microseconds{200}, 50);
        if (!found) {
            EXPECT_NE(waiting, Waiting::sleeping) << "everybody may sleep: " << found.error().message;
            EXPECT_FALSE(found.error().message.empty());
            continue;
        }
        ASSERT_EQ(found->late_us.size(), 50U);
        EXPECT_TRUE(std::is_sorted(found->late_us.begin(), found->late_us.end()));
        EXPECT_GE(found->late_us.front(), 0) << "nobody wakes up before the instant";
        EXPECT_EQ(found->processor.empty(), waiting < Waiting::one_core);
    }
}

TEST(WakeupLatency, CountsWhatIsLaterThanALimitAndNotWhatIsAtIt) {
    WakeupLatency const sut{{10, 20, 30, 900, 5000}, ""};
    EXPECT_EQ(sut.later_than(900), 1U);
    EXPECT_EQ(sut.later_than(29), 3U);
    EXPECT_EQ(sut.percentile_us(0.5), 30);
    EXPECT_EQ(sut.percentile_us(1), 5000);
}

TEST(WakeupLatency, ClassesHoldEveryWakeUpOnceAndDoubleTheirWidth) {
    std::vector<double> const late{0.2, 0.9, 3, 3.5, 4, 70};
    auto const classes = lateness_classes(late);
    ASSERT_EQ(classes.size(), 8U);
    EXPECT_EQ(classes.front().from_us, 0);
    EXPECT_EQ(classes.front().count, 2U);
    EXPECT_EQ(classes[1].count, 0U) << "1 to 2 us";
    EXPECT_EQ(classes[2].count, 2U) << "2 to 4 us, without 4 itself";
    EXPECT_EQ(classes.back().below_us, 128);
    EXPECT_EQ(std::accumulate(classes.begin(), classes.end(), std::size_t{0},
                              [](std::size_t sum, auto const& one) { return sum + one.count; }),
              late.size());
    EXPECT_TRUE(lateness_classes({}).empty());
    EXPECT_EQ(lateness_classes(std::vector<double>{100}).front().from_us, 64) << "empty classes in front are left out";
}

TEST(WakeupLatency, FindsTheLastOfTheProcessorsThatTheKernelKeepsFree) {
    EXPECT_EQ(last_processor(""), -1);
    EXPECT_EQ(last_processor("3"), 3);
    EXPECT_EQ(last_processor("2-5"), 5);
    EXPECT_EQ(last_processor("1,4-6,12"), 12);
}

} // namespace
} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/sample_stamp.hpp"

#include <gtest/gtest.h>

namespace gridspace::bus {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kIn2019 = 1'575'190'800 * kSecond, kIn2040 = 2'208'988'800 * kSecond;

TEST(SampleStamp, UntilTheYear2038IsTheTime) {
    EXPECT_EQ(stamp_of(kIn2019 + 5), kIn2019 + 5);
    EXPECT_EQ(stamp_after(kIn2019 + 5, kIn2019), 5);
    EXPECT_EQ(stamp_after(kIn2019 - 5, kIn2019), -5);
}

TEST(SampleStamp, OfALaterTimeFitsInto31BitsOfSecondsAndIsFoundAgain) {
    for (std::int64_t const epoch : {kIn2040, kStampPeriodNs - 3 * kSecond, kStampPeriodNs, 3 * kIn2040}) {
        for (std::int64_t const after : {-5 * kSecond, std::int64_t{0}, 7 * kSecond + 1, 30 * 365 * 86400 * kSecond}) {
            std::int64_t const stamp = stamp_of(epoch + after);
            EXPECT_GE(stamp, 0);
            EXPECT_LT(stamp / kSecond, 0x7fffffff) << "DDS takes this for never";
            EXPECT_EQ(stamp_after(stamp, epoch), after) << epoch;
            EXPECT_EQ(stamp_after(epoch + after, epoch), after) << "one that did not go over DDS";
        }
    }
}

} // namespace
} // namespace gridspace::bus

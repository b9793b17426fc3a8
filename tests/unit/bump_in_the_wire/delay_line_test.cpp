// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/bump_in_the_wire/delay_line.hpp"

#include <gtest/gtest.h>
#include <vector>

namespace gridspace::gateways {
namespace {

using Octets = std::vector<std::uint8_t>;

Octets popped(DelayLine& sut, std::int64_t until_ns) {
    auto const waiting = sut.pop(until_ns);
    return waiting ? Octets{waiting->octets.begin(), waiting->octets.end()} : Octets{};
}

TEST(DelayLine, LetsFramesGoInTheOrderOfTheirTimes) {
    DelayLine sut{8};
    ASSERT_TRUE(sut.push(30, Octets{3}));
    ASSERT_TRUE(sut.push(10, Octets{1}));
    ASSERT_TRUE(sut.push(20, Octets{2}));
    EXPECT_EQ(sut.next_ns(), 10);
    EXPECT_EQ(popped(sut, 100), (Octets{1}));
    EXPECT_EQ(popped(sut, 100), (Octets{2}));
    EXPECT_EQ(popped(sut, 100), (Octets{3}));
    EXPECT_EQ(sut.next_ns(), std::nullopt);
}

TEST(DelayLine, KeepsTheOrderOfArrivalAtEqualTimes) {
    DelayLine sut{8};
    for (std::uint8_t i = 0; i < 8; ++i) {
        ASSERT_TRUE(sut.push(5, Octets{i}));
    }
    for (std::uint8_t i = 0; i < 8; ++i) {
        EXPECT_EQ(popped(sut, 5), (Octets{i}));
    }
}

TEST(DelayLine, HoldsBackWhatIsNotDue) {
    DelayLine sut{8};
    ASSERT_TRUE(sut.push(10, Octets{1, 2, 3}));
    EXPECT_FALSE(sut.pop(9));
    EXPECT_EQ(popped(sut, 10), (Octets{1, 2, 3}));
    EXPECT_FALSE(sut.pop(10));
}

TEST(DelayLine, SaysWhenItIsFullAndLosesNothingElse) {
    DelayLine sut{2};
    ASSERT_TRUE(sut.push(1, Octets{1}));
    ASSERT_TRUE(sut.push(2, Octets{2}));
    EXPECT_FALSE(sut.push(3, Octets{3}));
    EXPECT_EQ(popped(sut, 9), (Octets{1}));
    EXPECT_TRUE(sut.push(4, Octets{4, 4}));
    EXPECT_EQ(popped(sut, 9), (Octets{2}));
    EXPECT_EQ(popped(sut, 9), (Octets{4, 4}));
}

} // namespace
} // namespace gridspace::gateways

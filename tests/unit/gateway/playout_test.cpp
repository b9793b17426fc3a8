// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/playout.hpp"

#include <gtest/gtest.h>

namespace gridspace::gateways {
namespace {

constexpr std::int64_t kMs = 1'000'000, kZero = 5'000 * kMs; // when simulated time was 0

TEST(Playout, ASampleLeavesABufferAfterItsInstantHoweverLateTheFirstOneCame) {
    Playout sut{1000, 0.0015};
    sut.begin(0, kZero + 40 * kMs, kZero);
    EXPECT_EQ(sut.due(0), kZero + 1'500'000);
    EXPECT_EQ(sut.due(1000), kZero + 1'500'000 + 1000 * kMs);
}

TEST(Playout, WhoJoinsLateTakesThePlaceThatHeWouldHaveHad) {
    Playout sut{1000, 0.002};
    sut.begin(700, kZero + 701 * kMs, kZero);
    EXPECT_EQ(sut.due(700), kZero + 702 * kMs);
}

TEST(Playout, WithoutAClockTheFirstArrivalCounts) {
    Playout sut{1000, 0.002};
    sut.begin(7, kZero, std::nullopt);
    EXPECT_EQ(sut.due(7), kZero + 2 * kMs);
    EXPECT_EQ(sut.due(8), kZero + 3 * kMs);
}

TEST(Playout, AClockThatIsBehindDoesNotHoldSamplesBack) {
    Playout sut{1000, 0.002};
    sut.begin(0, kZero + kMs, kZero + 100 * kMs);
    EXPECT_EQ(sut.due(0), kZero + 3 * kMs);
}

TEST(Playout, KnowsWhichSampleIsDue) {
    Playout sut{4800, 0.0015};
    sut.begin(0, kZero, kZero);
    for (std::int64_t const index : {0, 1, 47, 4799, 1'000'003}) {
        EXPECT_EQ(sut.index_at(sut.due(index)), index);
        EXPECT_EQ(sut.index_at(sut.due(index) - 1), index - 1);
    }
}

TEST(Playout, WhatComesLateAgainAndAgainLeavesLaterAndAnOddOneChangesNothing) {
    Playout sut{1000, 0.002};
    sut.begin(0, kZero, kZero);
    std::int64_t const before = sut.due(5000);
    auto const second = [&](int late) {
        bool moved = false;
        for (int slot = 0; slot < 1000; ++slot) {
            if (slot < late) {
                sut.came_late(slot == 0 ? 3 * kMs : kMs);
            }
            moved = sut.slot();
        }
        return moved;
    };
    EXPECT_FALSE(second(10));
    EXPECT_EQ(sut.due(5000), before);
    EXPECT_TRUE(second(250));
    EXPECT_EQ(sut.due(5000), before + 3 * kMs);
    EXPECT_FALSE(second(0));
}

} // namespace
} // namespace gridspace::gateways

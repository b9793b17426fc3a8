// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/inbox.hpp"

#include <gtest/gtest.h>

namespace gridspace::bus {
namespace {

bool push(CdrReader& reader, std::int64_t quanta, std::size_t octets) {
    return reader.push(std::vector<std::byte>(octets), Origin{{quanta}, 0, 0, static_cast<std::uint64_t>(quanta)},
                       TimeBase{});
}

TEST(CdrReader, WithoutABoundKeepsEverythingUntilItsTime) {
    CdrReader sut;
    for (int i = 0; i < 1000; ++i) {
        ASSERT_TRUE(push(sut, i, 1000));
    }
    sut.release({499});
    EXPECT_EQ(sut.take().size(), 500U);
    sut.release({INT64_MAX});
    EXPECT_EQ(sut.take().size(), 500U);
    EXPECT_EQ(sut.dropped(), 0U);
}

TEST(CdrReader, BeyondItsBoundTheNewestAreDroppedAndCountedAndRoomIsUsedAgain) {
    CdrReader sut;
    sut.bound(10'000);
    sut.release({INT64_MAX});
    for (int i = 0; i < 25; ++i) {
        EXPECT_TRUE(push(sut, i, 1000)); // dropping is no error of the sample
    }
    auto const kept = sut.take();
    ASSERT_EQ(kept.size(), 10U);
    EXPECT_EQ(kept.back().origin.sequence, 9U);
    EXPECT_EQ(sut.dropped(), 15U);
    EXPECT_TRUE(push(sut, 30, 10'000));
    EXPECT_EQ(sut.take().size(), 1U);
    EXPECT_EQ(sut.dropped(), 15U);
}

} // namespace
} // namespace gridspace::bus

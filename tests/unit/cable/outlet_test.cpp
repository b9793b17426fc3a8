// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/cable/ends.hpp"

#include <array>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace gridspace::cable {
namespace {

TEST(CableOutlet, HoldsNoMoreThanWhatWaitsHoweverLongItsReaderIsBehind) {
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe(ends.data()), 0);
    Outlet sut{ends[1]};
    std::string const frame(10'000, 'x');
    std::string taken(10'000, ' ');
    std::size_t total = 0;
    while (!sut.full()) {
        sut.send(Kind::frame, 1, frame);
    }
    for (int i = 0; i < 2000; ++i) { // 20 MB, of which a megabyte waits all the time
        ASSERT_TRUE(sut.flush());
        ssize_t const size = ::read(ends[0], taken.data(), taken.size());
        ASSERT_GT(size, 0);
        total += static_cast<std::size_t>(size);
        while (!sut.full()) {
            sut.send(Kind::frame, 1, frame);
        }
        ASSERT_LT(sut.held(), 3U << 20U);
    }
    EXPECT_GT(total, 15U << 20U);
    EXPECT_FALSE(sut.empty());
    ::close(ends[0]);
    ::close(ends[1]);
}

} // namespace
} // namespace gridspace::cable

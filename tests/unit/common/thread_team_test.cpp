// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/team.hpp"

#include <atomic>
#include <gtest/gtest.h>
#include <memory>
#include <thread>
#include <vector>

namespace gridspace {
namespace {

TEST(ThreadTeam, DoesEachPartOnceInEveryRound) {
    for (int const threads : {1, 2, 3, 7}) {
        auto const sut = make_thread_team(threads);
        ASSERT_EQ(sut->size(), threads);
        std::vector<int> done(static_cast<std::size_t>(threads), 0); // no atomics: run() orders what parts write
        for (int round = 1; round <= 2000; ++round) {
            sut->run([&](int part) { ++done[static_cast<std::size_t>(part)]; });
            ASSERT_EQ(done, std::vector<int>(static_cast<std::size_t>(threads), round));
        }
    }
}

TEST(ThreadTeam, APartSeesWhatAllPartsOfTheRoundBeforeWrote) {
    auto const sut = make_thread_team(3);
    std::vector<long> values(3, 1), next(3, 0);
    for (int round = 0; round < 500; ++round) {
        sut->run([&](int k) { next[static_cast<std::size_t>(k)] = (values[0] + values[1] + values[2] + k) % 1009; });
        std::swap(values, next);
    }
    std::vector<long> expected(3, 1);
    for (int round = 0; round < 500; ++round) {
        long const sum = expected[0] + expected[1] + expected[2];
        expected = {sum % 1009, (sum + 1) % 1009, (sum + 2) % 1009};
    }
    EXPECT_EQ(values, expected);
}

TEST(ThreadTeam, IsReadyForTheNextRoundWhenItsThreadsHaveGoneToSleep) {
    auto const sut = make_thread_team(2);
    std::atomic<int> others{0};
    for (int round = 0; round < 20; ++round) {
        // Longer than they spin, in what they spend themselves: some thousand yields.
        for (int i = 0; i < 2000; ++i) {
            std::this_thread::yield();
        }
        sut->run([&](int) { ++others; });
    }
    EXPECT_EQ(others, 40);
}

TEST(ThreadTeam, EndsWhetherItWasUsedOrNot) {
    for (int i = 0; i < 50; ++i) {
        auto const unused = make_thread_team(4);
        auto const used = make_thread_team(4);
        used->run([](int) {});
    }
    SUCCEED(); // it hangs otherwise
}

} // namespace
} // namespace gridspace

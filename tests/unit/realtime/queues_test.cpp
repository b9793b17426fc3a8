// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What hands work from the simulating thread to the publishing one, and from a receiver to whoever sends.
#include "common/spsc_ring.hpp"
#include "common/triple_buffer.hpp"
#include "sim/app/publisher_thread.hpp"
#include "sim/gateway/outbox.hpp"

#include <gtest/gtest.h>
#include <semaphore>
#include <thread>
#include <vector>

namespace gridspace::sim {
namespace {

TEST(SpscRing, RefusesWhatDoesNotFitAndGoesOnBehindIt) {
    SpscRing<int> sut{3};
    int out = 0;
    EXPECT_FALSE(sut.pop(out));
    EXPECT_EQ(sut.front(), nullptr);
    for (int round = 0; round < 5; ++round) {
        for (int i = 0; i < 3; ++i) {
            EXPECT_TRUE(sut.push(10 * round + i));
        }
        EXPECT_FALSE(sut.push(99));
        ASSERT_NE(sut.front(), nullptr);
        EXPECT_EQ(*sut.front(), 10 * round) << "looking takes nothing";
        for (int i = 0; i < 3; ++i) {
            EXPECT_TRUE(sut.pop(out));
            EXPECT_EQ(out, 10 * round + i);
        }
        EXPECT_TRUE(sut.empty());
    }
}

TEST(SpscRing, BringsEveryElementOnceAndInOrderFromOneThreadToAnother) {
    constexpr std::uint32_t kCount = 200'000;
    SpscRing<std::uint32_t> sut{64};
    std::thread writer{[&] {
        for (std::uint32_t i = 0; i < kCount;) {
            if (sut.push(i)) {
                ++i;
            } else {
                std::this_thread::yield();
            }
        }
    }};
    for (std::uint32_t expected = 0, value = 0; expected < kCount;) {
        if (sut.pop(value)) {
            ASSERT_EQ(value, expected++);
        } else {
            std::this_thread::yield();
        }
    }
    writer.join();
}

TEST(TripleBuffer, GivesTheNewestWholeValueAndNeverAnOlderOneLater) {
    struct Pair {
        std::uint64_t a{0}, b{0};
    };
    constexpr std::uint64_t kLast = 200'000;
    TripleBuffer<Pair> sut{{}};
    EXPECT_EQ(sut.front().a, 0U) << "the initial value, until there is another";
    std::thread writer{[&] {
        for (std::uint64_t i = 1; i <= kLast; ++i) {
            sut.back() = {i, ~i};
            sut.publish();
        }
    }};
    std::uint64_t seen = 0;
    while (seen < kLast) {
        Pair const now = sut.front();
        ASSERT_TRUE(now.a == 0 || now.b == ~now.a) << "torn";
        ASSERT_GE(now.a, seen);
        seen = now.a;
    }
    writer.join();
}

TEST(Outbox, HandsOutUpToTheEndOfATickInOrderAndCountsWhatDidNotFit) {
    Outbox<int> sut{4};
    for (int i = 1; i <= 6; ++i) {
        sut.put(SimTime{10 * i}, i);
    }
    EXPECT_EQ(sut.lost(), 2U);
    std::vector<std::pair<int, std::int64_t>> out;
    auto const write = [&](int value, SimTime time) { out.emplace_back(value, time.quanta); };
    sut.drain(SimTime{20}, write);
    EXPECT_EQ(out, (std::vector<std::pair<int, std::int64_t>>{{1, 10}, {2, 20}}))
        << "what belongs to the next tick waits";
    sut.drain(SimTime{20}, write);
    EXPECT_EQ(out.size(), 2U);
    sut.put(SimTime{70}, 7);
    sut.drain(SimTime{100}, write);
    EXPECT_EQ(out, (std::vector<std::pair<int, std::int64_t>>{{1, 10}, {2, 20}, {3, 30}, {4, 40}, {7, 70}}));
}

TEST(PublisherThread, WritesEveryTickInOrderOnItsOwnThreadAndEndsBehindTheLast) {
    std::vector<std::int64_t> written;
    std::thread::id writer;
    PublisherThread sut{[&](SimTime end, bool) -> Result<void> {
        written.push_back(end.quanta);
        writer = std::this_thread::get_id();
        return {};
    }};
    for (std::int64_t tick = 1; tick <= 1000; ++tick) {
        ASSERT_TRUE(sut.tick_ended(SimTime{tick}, tick == 1000));
    }
    ASSERT_TRUE(sut.finish());
    ASSERT_EQ(written.size(), 1000U);
    for (std::int64_t tick = 1; tick <= 1000; ++tick) {
        EXPECT_EQ(written[static_cast<std::size_t>(tick - 1)], tick);
    }
    EXPECT_NE(writer, std::this_thread::get_id());
    EXPECT_FALSE(sut.failed());
}

TEST(PublisherThread, NeverMakesTheSimulatingThreadWaitForAWriteThatHangs) {
    std::binary_semaphore hanging{0}, go_on{0};
    PublisherThread sut{[&](SimTime end, bool) -> Result<void> {
        if (end.quanta == 1) {
            hanging.release();
            go_on.acquire();
        }
        return {};
    }};
    ASSERT_TRUE(sut.tick_ended(SimTime{1}, false));
    hanging.acquire();
    std::int64_t taken = 1;
    while (taken < 100'000 && sut.tick_ended(SimTime{taken + 1}, false)) {
        ++taken;
    }
    EXPECT_LT(taken, 100'000) << "hundreds of ticks behind, it says so instead of waiting";
    EXPECT_GE(taken, 100);
    go_on.release();
}

TEST(PublisherThread, TellsWhyItCouldNotWrite) {
    PublisherThread sut{[](SimTime end, bool) -> Result<void> {
        return end.quanta < 3 ? Result<void>{} : fail(ExitCode::stall, "the bus is gone");
    }};
    for (std::int64_t tick = 1; tick <= 3; ++tick) {
        (void)sut.tick_ended(SimTime{tick}, false);
    }
    auto const done = sut.finish();
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().message, "the bus is gone");
    EXPECT_TRUE(sut.failed());
    EXPECT_FALSE(sut.tick_ended(SimTime{4}, true));
}

TEST(PublisherThread, CanBeLeftInTheMiddle) {
    std::binary_semaphore began{0};
    {
        PublisherThread sut{[&](SimTime, bool) -> Result<void> {
            began.release();
            return {};
        }};
        ASSERT_TRUE(sut.tick_ended(SimTime{1}, false));
        began.acquire();
    } // the destructor returns
    PublisherThread idle{[](SimTime, bool) -> Result<void> { return {}; }};
}

} // namespace
} // namespace gridspace::sim

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/port/arrival_clock.hpp"

#include "gateways/iec61850/goose_subscriber.hpp"
#include "gateways/iec61850/sv_subscriber.hpp"

#include <gtest/gtest.h>
#include <utility>
#include <vector>

namespace gridspace::gateways {
namespace {

constexpr std::int64_t kMs = 1'000'000, kS = 1'000'000'000;
constexpr std::int64_t kUtc = 1'800'000'000 * kS; ///< UTC when the monotonic clock shows 0

/// A machine whose UTC can be set.
struct Machine {
    std::int64_t steady{0}, utc_is_ahead{kUtc};
    [[nodiscard]] ArrivalClock::Reading read() const { return {steady, steady + utc_is_ahead}; }
    [[nodiscard]] std::int64_t stamp() const { return steady + utc_is_ahead; }
};

TEST(ArrivalClock, FramesThatWaitedHaveTheTimesAtWhichTheyCame) {
    Machine machine;
    ArrivalClock sut{0};
    std::vector<std::int64_t> stamps;
    for (machine.steady = 10 * kMs; machine.steady <= 2 * kS; machine.steady += 10 * kMs) {
        stamps.push_back(machine.stamp());
    }
    for (std::size_t i = 0; i < stamps.size(); ++i) {
        EXPECT_EQ(sut.arrival(stamps[i], machine.read()), static_cast<std::int64_t>(i + 1) * 10 * kMs);
    }
}

TEST(ArrivalClock, AFrameWithoutAStampCameWhenItWasRead) {
    Machine machine{5 * kS};
    ArrivalClock sut{0};
    EXPECT_EQ(sut.arrival(0, machine.read()), 5 * kS);
}

TEST(ArrivalClock, ArrivalsNeverGoBack) {
    Machine machine{5 * kS};
    ArrivalClock sut{0};
    EXPECT_EQ(sut.arrival(machine.stamp() - 3 * kMs, machine.read()), 5 * kS - 3 * kMs);
    EXPECT_EQ(sut.arrival(machine.stamp() - 7 * kMs, machine.read()), 5 * kS - 3 * kMs); // another processor's stamp
    EXPECT_EQ(sut.arrival(0, machine.read()), 5 * kS);
    EXPECT_EQ(sut.arrival(machine.stamp() - 1 * kMs, machine.read()), 5 * kS);
}

TEST(ArrivalClock, AClockThatIsSetBackMakesNoFrameComeLaterThanItIsRead) {
    Machine machine{5 * kS};
    ArrivalClock sut{0};
    std::int64_t const stamp = machine.stamp();
    machine.utc_is_ahead -= 3600 * kS;
    machine.steady += 10 * kMs;
    EXPECT_EQ(sut.arrival(stamp, machine.read()), machine.steady);
    machine.steady += 10 * kMs;
    EXPECT_EQ(sut.arrival(machine.stamp() - 2 * kMs, machine.read()), machine.steady - 2 * kMs)
        << "and the next one is as exact as ever";
}

TEST(ArrivalClock, AClockThatIsSetForwardMakesNoFrameOlderThanTheLastLookWithoutIt) {
    Machine machine{5 * kS};
    ArrivalClock sut{0};
    sut.nothing_at(machine.steady);
    machine.steady += 10 * kMs;
    std::int64_t const stamp = machine.stamp();
    machine.utc_is_ahead += 3600 * kS;
    machine.steady += 10 * kMs;
    EXPECT_EQ(sut.arrival(stamp, machine.read()), 5 * kS);
    EXPECT_EQ(sut.arrival(machine.stamp() - 2 * kMs, machine.read()), machine.steady - 2 * kMs)
        << "and the next one is as exact as ever";
}

TEST(ArrivalClock, NothingCameBeforeThePortWasOpened) {
    Machine machine{5 * kS};
    ArrivalClock sut{5 * kS - 3 * kMs};
    EXPECT_EQ(sut.arrival(kUtc - 3600 * kS, machine.read()), 5 * kS - 3 * kMs);
}

TEST(ArrivalClock, ItsTwoClocksAreReadTogether) {
    ArrivalClock::Reading const first = ArrivalClock::read(), second = ArrivalClock::read();
    EXPECT_LE(first.steady_ns, second.steady_ns);
    EXPECT_GT(first.utc_ns, 1'500'000'000 * kS);
}

/// 400 Hz, nobody reads for two seconds in between, then everything at once.
TEST(ArrivalClock, AStallOfTheReaderIsNoLossOfSamples) {
    iec61850::SvSubscription subscription;
    subscription.rate_hz = 400;
    subscription.wrap = 400;
    iec61850::SvSubscriber sut{subscription};
    Machine machine;
    ArrivalClock clock{0};
    std::vector<std::pair<std::uint16_t, std::int64_t>> waiting; // counter, stamp
    for (int k = 0; k < 2000; ++k) {
        machine.steady = k * 2'500'000LL;
        waiting.emplace_back(static_cast<std::uint16_t>(k % 400), machine.stamp());
        bool const stalled = k >= 500 && k < 1300;
        machine.steady += 50'000;
        for (; !stalled && !waiting.empty(); waiting.erase(waiting.begin())) {
            std::int64_t const arrival = clock.arrival(waiting.front().second, machine.read());
            ASSERT_EQ(sut.receive(waiting.front().first, arrival).index, k + 1 - static_cast<int>(waiting.size()));
        }
    }
    EXPECT_EQ(sut.counters().samples, 2000U);
    EXPECT_EQ(sut.counters().lost, 0U);
    EXPECT_EQ(sut.counters().of(iec61850::SvEvent::unconfirmed), 0U);
    EXPECT_NEAR(sut.arrivals().rate_hz(), 400, 0.01);
}

} // namespace
} // namespace gridspace::gateways

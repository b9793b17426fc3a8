// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/futexes.hpp"
#include "timebox/simulated_clock.hpp"
#include "timebox/timers.hpp"

#include <gtest/gtest.h>
#include <sys/eventfd.h>

namespace gridspace::timebox {
namespace {

TEST(SimulatedClock, ShowsEachClockFromItsOwnZeroAndGoesOnWithEachLook) {
    SimulatedClock sut{1000};
    sut.elapse_to(5);
    EXPECT_EQ(sut.reading_ns(CLOCK_MONOTONIC), 5);
    EXPECT_EQ(sut.reading_ns(CLOCK_REALTIME), 1'000'000'000'005);
    EXPECT_EQ(sut.reading_ns(CLOCK_TAI), 1'037'000'000'005);
    EXPECT_EQ(sut.when(CLOCK_REALTIME, 1'000'000'000'700), 700);
    sut.look();
    EXPECT_EQ(sut.now_ns(), 105);
    sut.elapse_to(50);
    EXPECT_EQ(sut.now_ns(), 105) << "it never goes back";
}

TEST(Futexes, WakeInTheOrderOfWaiting) {
    Futexes sut;
    Futexes::Place const here{1, 100}, there{1, 200};
    for (pid_t const tid : {5, 3, 4}) {
        sut.wait(tid, here, 7, 0xFFFFFFFF);
    }
    sut.wait(6, there, 7, 0b10);
    EXPECT_EQ(sut.wake(here, 0xFFFFFFFF, 2), 2);
    EXPECT_TRUE(sut.is_woken(5));
    EXPECT_TRUE(sut.is_woken(3));
    EXPECT_FALSE(sut.is_woken(4));
    EXPECT_EQ(sut.wake(there, 0b01, 9), 0) << "it waits for another bit";
    EXPECT_EQ(sut.wake(there, 0b11, 9), 1);
    sut.wake_changed([](Futexes::Place const&) { return 8U; });
    EXPECT_TRUE(sut.is_woken(4));
    sut.leave(4);
    EXPECT_FALSE(sut.is_woken(4));
}

TEST(Timers, RingAtTheirTimesAndCountWhatNobodyRead) {
    Timers sut;
    int const fd = ::eventfd(0, EFD_NONBLOCK);
    sut.create(1, 9, UniqueFd{fd}, CLOCK_MONOTONIC);
    sut.find(1, 9)->timer = Timer{100, 250};
    sut.set_alarm(2, Timer{300, 0});
    EXPECT_EQ(sut.next_ns(), 100);
    int alarms = 0;
    auto const ring = [&](std::int64_t now) {
        sut.ring(now, [&](pid_t process) { alarms += process == 2 ? 1 : 100; });
    };
    ring(99);
    ring(100);
    EXPECT_EQ(sut.next_ns(), 300);
    ring(860); // 350, 600, 850
    EXPECT_EQ(alarms, 1);
    EXPECT_EQ(sut.next_ns(), 1100);
    std::uint64_t rung = 0;
    ASSERT_EQ(::read(fd, &rung, sizeof rung), 8);
    EXPECT_EQ(rung, 4U);
    EXPECT_FALSE(sut.alarm_of(2)) << "once";
    sut.ended(1);
    EXPECT_EQ(sut.find(1, 9), nullptr);
}

} // namespace
} // namespace gridspace::timebox

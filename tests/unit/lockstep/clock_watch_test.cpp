// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/clock_watch.hpp"

#include <gtest/gtest.h>

namespace gridspace::bus {
namespace {

constexpr std::int64_t kUs = 1'000, kMs = 1000 * kUs, kSecond = 1000 * kMs, kNow = 1'700'000'000 * kSecond;

TEST(ClockWatch, NoticesThatTheClockIsSetForwardOrBack) {
    for (std::int64_t const by : {3600 * kSecond, -3600 * kSecond, 101 * kMs, -101 * kMs}) {
        ClockWatch sut;
        EXPECT_FALSE(sut.step(5 * kSecond, kNow, 5 * kSecond + kUs));
        EXPECT_FALSE(sut.step(6 * kSecond, kNow + kSecond, 6 * kSecond + kUs));
        EXPECT_EQ(sut.step(7 * kSecond, kNow + 2 * kSecond + by, 7 * kSecond + kUs), by);
    }
}

TEST(ClockWatch, ToleratesAClockThatIsMadeToRunFaster) {
    ClockWatch sut;
    for (std::int64_t t = 0; t < 100; ++t) { // 500 ppm, the most that the kernel slews
        EXPECT_FALSE(sut.step(t * kSecond, kNow + t * kSecond + t * kMs / 2, t * kSecond + kUs));
    }
}

TEST(ClockWatch, TakesItsOwnPreemptionBetweenTwoReadingsForNoStep) {
    ClockWatch sut;
    // Not scheduled for 300 ms behind the first reading: at once, and later.
    EXPECT_FALSE(sut.step(4 * kSecond, kNow - kSecond + 300 * kMs, 4 * kSecond + 300 * kMs));
    EXPECT_FALSE(sut.step(5 * kSecond, kNow, 5 * kSecond + kUs)) << "that look was no measure";
    EXPECT_FALSE(sut.step(6 * kSecond, kNow + kSecond + 300 * kMs, 6 * kSecond + 300 * kMs));
    EXPECT_FALSE(sut.step(7 * kSecond, kNow + 2 * kSecond, 7 * kSecond + 300 * kMs)) << "behind the second";
    EXPECT_EQ(sut.step(8 * kSecond, kNow + 5 * kSecond, 8 * kSecond + kUs), 2 * kSecond) << "a real one is still seen";
}

TEST(ClockWatch, NoticesAnotherClockThanTheSimulators) {
    ClockWatch sut;
    for (int i = 0; i < ClockWatch::kSamples; ++i) {
        EXPECT_FALSE(sut.offset(kNow + i * 160 * kMs, kNow + i * 160 * kMs - 300 * kMs)) << "not after sample " << i;
    }
    EXPECT_EQ(sut.offset(kNow + 3200 * kMs, kNow + 2900 * kMs), -300 * kMs);
    EXPECT_FALSE(sut.offset(kNow + 3360 * kMs, kNow + 3060 * kMs)) << "it is said once";
}

TEST(ClockWatch, TakesItsOwnLackOfAProcessorForNoOffsetHoweverManySamplesComeMeanwhile) {
    ClockWatch sut;
    for (int i = 0; i < 5000; ++i) { // at 900 times the pace of the wall clock
        std::int64_t const sent = kNow + i * kMs;
        EXPECT_FALSE(sut.offset(sent, sent + (i < 2500 ? 240 : 3) * kMs)) << i;
    }
}

TEST(ClockWatch, TakesALateSampleForNoOffset) {
    ClockWatch sut;
    for (int i = 0; i < 3 * ClockWatch::kSamples; ++i) { // a busy machine: all late but one
        EXPECT_FALSE(sut.offset(kNow + i * kSecond, kNow + i * kSecond + (i == 7 ? 2 * kMs : 450 * kMs)));
    }
}

TEST(ClockWatch, TakesWhatWasKeptForALateJoinerForNoOffset) {
    ClockWatch sut;
    for (int i = 0; i < 64; ++i) { // sent in 0.64 s, handed over in a moment
        EXPECT_FALSE(sut.offset(kNow + i * 10 * kMs, kNow + kSecond + i * kMs / 10));
    }
    for (int i = 0; i < 2 * ClockWatch::kSamples; ++i) {
        EXPECT_FALSE(sut.offset(kNow + kSecond + i * 10 * kMs, kNow + kSecond + i * 10 * kMs + 7 * kMs));
    }
}

TEST(ClockWatch, TakesWhatComesLateOnABusyMachineForNoOffsetOfItsOwnClock) {
    ClockWatch sut;
    std::optional<std::int64_t> ahead;
    for (int i = 0; i < 1000 && !ahead; ++i) { // nobody can tell it from an offset by its times
        ahead = sut.offset(kNow + i * 10 * kMs, kNow + i * 10 * kMs + 350 * kMs);
    }
    ASSERT_EQ(ahead, 350 * kMs);
    EXPECT_TRUE(ClockWatch::is_lateness(*ahead));
    EXPECT_FALSE(ClockWatch::is_lateness(-*ahead)); // nothing comes before it was sent
    EXPECT_FALSE(ClockWatch::is_lateness(3600 * kSecond));
}

} // namespace
} // namespace gridspace::bus

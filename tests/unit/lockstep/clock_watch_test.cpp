// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/clock_watch.hpp"

#include <gtest/gtest.h>

namespace gridspace::bus {
namespace {

constexpr std::int64_t kMs = 1'000'000, kSecond = 1000 * kMs, kNow = 1'700'000'000 * kSecond;

TEST(ClockWatch, NoticesThatTheClockIsSetForwardOrBack) {
    for (std::int64_t const by : {3600 * kSecond, -3600 * kSecond, 101 * kMs, -101 * kMs}) {
        ClockWatch sut;
        EXPECT_FALSE(sut.step(kNow, 5 * kSecond));
        EXPECT_FALSE(sut.step(kNow + kSecond, 6 * kSecond));
        EXPECT_EQ(sut.step(kNow + 2 * kSecond + by, 7 * kSecond), by);
    }
}

TEST(ClockWatch, ToleratesAClockThatIsMadeToRunFaster) {
    ClockWatch sut;
    for (std::int64_t t = 0; t < 100; ++t) { // 500 ppm, the most that the kernel slews
        EXPECT_FALSE(sut.step(kNow + t * kSecond + t * kMs / 2, t * kSecond));
    }
}

TEST(ClockWatch, NoticesAnotherClockThanTheSimulators) {
    ClockWatch sut;
    for (int i = 1; i < ClockWatch::kSamples; ++i) {
        EXPECT_FALSE(sut.offset(kNow + i * kSecond, kNow + i * kSecond - 300 * kMs)) << "not after sample " << i;
    }
    EXPECT_EQ(sut.offset(kNow, kNow - 300 * kMs), -300 * kMs);
    EXPECT_FALSE(sut.offset(kNow, kNow - 300 * kMs)) << "it is said once";
}

TEST(ClockWatch, TakesALateSampleForNoOffset) {
    ClockWatch sut;
    for (int i = 0; i < 2 * ClockWatch::kSamples; ++i) { // a busy machine: all late but one
        EXPECT_FALSE(sut.offset(kNow, kNow + (i == 7 ? 2 * kMs : 900 * kMs)));
    }
}

} // namespace
} // namespace gridspace::bus

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sdk/timers.hpp"

#include <gtest/gtest.h>

namespace gridspace::sdk {
namespace {

TEST(Timers, APeriodicOneIsDueAtItsWholeMultiples) {
    Timers sut;
    int const timer = sut.every(SimSpan{10}, SimTime{25}); // who begins at 25 begins with the period that it is in

    EXPECT_EQ(sut.next()->time, SimTime{20});
    sut.passed(timer);
    EXPECT_EQ(sut.next()->time, SimTime{30});
}

TEST(Timers, OfOneTimeTheFirstComesFirst) {
    Timers sut;
    int const first = sut.every(SimSpan{5}, SimTime{});
    int const second = sut.at(SimTime{});

    EXPECT_EQ(sut.next()->timer, first);
    sut.passed(first);
    EXPECT_EQ(sut.next()->timer, second);
}

TEST(Timers, WhatWasMissedIsLeftOut) {
    Timers sut;
    (void)sut.every(SimSpan{10}, SimTime{});
    (void)sut.at(SimTime{3});

    sut.skip([](SimTime due, SimSpan) { return due < SimTime{35}; });

    EXPECT_EQ(sut.next()->time, SimTime{3}) << "what is asked for once comes late";
    sut.passed(1);
    EXPECT_EQ(sut.next()->time, SimTime{40});
}

TEST(Timers, ThoseThatAreOverLeaveTheirNumber) {
    Timers sut;
    for (int i = 0; i < 1000; ++i) {
        int const timer = sut.at(SimTime{i});
        EXPECT_EQ(timer, 0);
        sut.passed(timer);
    }
    EXPECT_FALSE(sut.next());
    EXPECT_FALSE(sut.cancel(1));
}

} // namespace
} // namespace gridspace::sdk

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/stream/signal_window.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <gmock/gmock.h>

namespace gridspace::stream {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;

SignalWindow ramp(std::size_t rows, std::size_t capacity) {
    SignalWindow window{{{"x", "A"}, {"minus_x", "A"}}, capacity};
    for (std::size_t i = 0; i < rows; ++i) {
        double const x = static_cast<double>(i);
        window.append(static_cast<std::int64_t>(i) * 1'000'000'000, std::array{x, -x});
    }
    return window;
}

TEST(SignalWindow, GivesEverySampleWhileThereIsRoomOnTheScreen) {
    SignalWindow const sut = ramp(5, 100);
    EXPECT_THAT(sut.plot(0, 0, 10'000'000'000, 100).values, ElementsAre(0, 1, 2, 3, 4));
    EXPECT_THAT(sut.plot(1, 0, 10'000'000'000, 100).times_s, ElementsAre(0, 1, 2, 3, 4));
    EXPECT_EQ(sut.newest(1), -4);
}

TEST(SignalWindow, AddsOnePointOnEachSideOfTheView) {
    EXPECT_THAT(ramp(10, 100).plot(0, 4'000'000'000, 6'000'000'000, 100).values, ElementsAre(3, 4, 5, 6, 7));
}

TEST(SignalWindow, KeepsASpikeOfOneSampleHoweverFewColumnsThePlotHas) {
    SignalWindow sut{{{"x", ""}}, 100'000};
    for (int i = 0; i < 48'000; ++i) {
        sut.append(i, std::array{i == 31'337 ? 500.0 : std::sin(i * 0.01)});
    }
    Plot const plot = sut.plot(0, 0, 48'000, 50);
    EXPECT_LE(plot.values.size(), 100U);
    EXPECT_EQ(*std::max_element(plot.values.begin(), plot.values.end()), 500.0);
    EXPECT_TRUE(std::is_sorted(plot.times_s.begin(), plot.times_s.end()));
}

TEST(SignalWindow, TellsExtremesAtTheirOwnTimes) {
    SignalWindow sut{{{"v", "p.u."}}, 10'000};
    for (int i = 0; i < 8000; ++i) {
        sut.append(i * 1'000'000LL, std::array{i == 5500 ? 0.33 : i == 5600 ? 1.1 : 1.0});
    }
    Plot const plot = sut.plot(0, 0, 8'000'000'000, 3, Ends::inside);
    EXPECT_THAT(plot.times_s, ElementsAre(0, DoubleEq(2.666), DoubleEq(5.5), DoubleEq(5.6)))
        << "of what never changes one point is enough";
    EXPECT_THAT(plot.values, ElementsAre(1, 1, testing::DoubleNear(0.33, 1e-6), testing::DoubleNear(1.1, 1e-6)));
}

TEST(SignalWindow, TellsExtremesOfLongAgoWithinTheRowsThatTheyAreLeftOf) {
    SignalWindow sut{{{"v", ""}}, 64};
    for (int i = 0; i < 1600; ++i) { // of the first rows lowest and highest of 256 are left
        sut.append(i * 1'000'000LL, std::array{i == 700 ? -1.0 : i == 1000 ? 2.0 : 0.0});
    }
    Plot const plot = sut.plot(0, 0, 1'599'000'000, 1, Ends::inside);
    EXPECT_THAT(plot.values, ElementsAre(-1, 2));
    EXPECT_NEAR(plot.times_s[0], 0.7, 0.256);
    EXPECT_NEAR(plot.times_s[1], 1.0, 0.256);
}

TEST(SignalWindow, KeepsTheExtremesOfLongAgoInBoundedMemory) {
    SignalWindow sut{{{"x", ""}}, 64};
    for (int i = 0; i < 10'000; ++i) {
        sut.append(i * 1000, std::array{i == 17 ? -7.0 : i == 18 ? 9.0 : 0.0});
    }
    EXPECT_EQ(sut.oldest_ns(), 0);
    Plot const all = sut.plot(0, 0, 10'000'000, 500);
    EXPECT_EQ(*std::min_element(all.values.begin(), all.values.end()), -7.0);
    EXPECT_EQ(*std::max_element(all.values.begin(), all.values.end()), 9.0);
    EXPECT_LE(all.values.size(), 2 * 64U);
    Plot const newest = sut.plot(0, 9'990'000, 9'999'000, 500); // and the newest rows are still as they came
    EXPECT_EQ(newest.values.size(), 11U);
}

TEST(SignalWindow, ShowsWhatFollowsUponNothing) {
    SignalWindow sut{{{"x", ""}}, 1000};
    for (int i = 0; i < 400; ++i) {
        sut.append(i, std::array{i % 100 < 50 ? NAN : i == 370 ? 9.0 : 1.0});
    }
    Plot const plot = sut.plot(0, 0, 400, 4); // each column begins with nothing
    EXPECT_EQ(std::count(plot.values.begin(), plot.values.end(), 9.0), 1);
    EXPECT_GE(std::count(plot.values.begin(), plot.values.end(), 1.0), 4);
}

TEST(SignalWindow, StaysInsideWhenAsked) {
    EXPECT_THAT(ramp(10, 100).plot(0, 4'000'000'000, 6'000'000'000, 100, Ends::inside).values, ElementsAre(4, 5, 6));
    EXPECT_TRUE(ramp(10, 100).plot(0, 4'200'000'000, 4'800'000'000, 100, Ends::inside).values.empty());
    for (double const t : ramp(10'000, 64).plot(0, 5'000'000'000, 70'000'000'000, 20, Ends::inside).times_s) {
        EXPECT_TRUE(t >= 5 && t <= 70) << t;
    }
}

TEST(SignalWindow, LeavesOutRowsThatCameTwiceOrHaveAnotherWidth) {
    SignalWindow sut{{{"x", ""}}, 10};
    sut.append(5, std::array{1.0});
    sut.append(5, std::array{2.0});
    sut.append(4, std::array{3.0});
    sut.append(6, std::array{4.0, 5.0});
    EXPECT_EQ(sut.rows(), 1U);
    EXPECT_EQ(sut.newest(0), 1.0);
}

TEST(SignalWindow, KnowsTheValueThatHeldAtAnInstant) {
    SignalWindow const sut = ramp(5, 100);
    EXPECT_TRUE(std::isnan(sut.value_at(0, -1)));
    EXPECT_EQ(sut.value_at(0, 0), 0);
    EXPECT_EQ(sut.value_at(1, 2'999'999'999), -2);
    EXPECT_EQ(sut.value_at(1, 3'000'000'000), -3);
    EXPECT_EQ(sut.value_at(0, 99'000'000'000), 4);
}

TEST(SignalWindow, KnowsWhatHeldLongAgoToTheBucket) {
    SignalWindow const sut = ramp(1000, 32);
    EXPECT_EQ(sut.value_at(0, 990'000'000'000), 990); // still there as it came
    EXPECT_NEAR(sut.value_at(0, 600'000'000'000), 600, 16);
}

TEST(SignalWindow, AnswersForNothingWhenThereIsNothing) {
    SignalWindow const sut{{{"x", ""}}, 10};
    EXPECT_TRUE(sut.plot(0, 0, 10, 10).values.empty());
    EXPECT_TRUE(ramp(3, 10).plot(7, 0, 10, 10).values.empty());
    EXPECT_TRUE(ramp(3, 10).plot(0, 10, 0, 10).values.empty());
}

TEST(SignalWindow, KeepsLessOfThePastWhereOthersHaveTakenTheMemory) {
    auto const left = std::make_shared<std::size_t>(2000);
    SignalWindow sut{{{"x", ""}, {"y", ""}}, 10'000, left}, other{{{"x", ""}}, 10'000, left};
    for (int i = 0; i < 5000; ++i) {
        double const x = i;
        sut.append(i, std::array{x, -x});
    }
    EXPECT_EQ(sut.taken() + *left, 2000U);
    EXPECT_LT(*left, 4U);
    EXPECT_EQ(sut.newest(1), -4999);
    EXPECT_EQ(sut.value_at(0, 4990), 4990);
    EXPECT_EQ(sut.plot(0, 4980, 4999, 100, Ends::inside).values.size(), 20U);
    EXPECT_EQ(sut.oldest_ns(), 0) << "the coarsest level goes back to the beginning";
    for (int i = 0; i < 100; ++i) { // little is left for it but the first rows
        double const x = i;
        other.append(i, std::span{&x, 1});
        EXPECT_EQ(other.value_at(0, i), x);
    }
    EXPECT_EQ(sut.taken() + other.taken() + *left, 2000U) << "no more comes back than was taken";
}

} // namespace
} // namespace gridspace::stream

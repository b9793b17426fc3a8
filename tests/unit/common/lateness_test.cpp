// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/lateness.hpp"

#include "common/nearest_rank.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <vector>

using gridspace::Lateness;
using std::chrono::nanoseconds;

TEST(Lateness, OfNothingIsNothing) {
    Lateness::Summary const s = Lateness{nanoseconds{1000}}.summary();
    EXPECT_EQ(s.instants, 0u);
    EXPECT_EQ(s.p50_us, 0);
    EXPECT_EQ(s.worst_us, 0);
    EXPECT_EQ(s.period_us, 1);
}

TEST(Lateness, CountsExactlyWhatIsLaterThanAPeriodAndTakesEarlyForNotLate) {
    Lateness lateness{nanoseconds{833'333}};
    for (int const ns : {-5, 0, 833'332, 833'333, 833'334, 90'000'000}) {
        lateness.add(nanoseconds{ns});
    }
    Lateness::Summary const s = lateness.summary();
    EXPECT_EQ(s.instants, 6u);
    EXPECT_EQ(s.later_than_a_period, 2u);
    EXPECT_EQ(s.worst_us, 90'000);
}

TEST(Lateness, PercentilesAreAtMostAnEighthTooLargeAndNeverTooSmall) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        std::mt19937_64 random{seed};
        std::lognormal_distribution<double> ns{seed * 0.9, 1.5}; // from nanoseconds to minutes
        Lateness lateness{nanoseconds{1}};
        std::vector<double> all;
        for (int i = 0; i < 3000; ++i) {
            auto const late = static_cast<std::int64_t>(ns(random));
            lateness.add(nanoseconds{late});
            all.push_back(static_cast<double>(late) / 1e3);
        }
        std::ranges::sort(all);
        Lateness::Summary const s = lateness.summary();
        EXPECT_EQ(s.worst_us, all.back());
        for (auto const& [found, share] : {std::pair{s.p50_us, 0.5}, {s.p99_us, 0.99}, {s.p999_us, 0.999}}) {
            double const exact = gridspace::nearest_rank(all, share);
            EXPECT_GE(found, exact) << seed << " " << share;
            EXPECT_LE(found, exact * 1.125 + 1e-9) << seed << " " << share;
        }
    }
}

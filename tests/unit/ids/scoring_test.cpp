// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/scoring/scorer.hpp"

#include <gtest/gtest.h>

namespace gridspace::ids {
namespace {

ScoredVerdict said(std::int64_t index, bool flagged, std::uint8_t channel = 0) {
    ScoredVerdict v;
    v.stream = "SMV21";
    v.index = index;
    v.channel = channel;
    v.limit_a = 0.36;
    v.flagged = v.open_flagged = flagged;
    return v;
}

ScoredLabel label(std::int64_t index, double error_a, std::string attack = "fakes") {
    return {std::move(attack), "SMV21", index, 0, 10, 10 + error_a};
}

TEST(Share, HasWilsonsInterval) {
    Share const s = share_of(273, 48434); // the published false positives
    EXPECT_NEAR(s.percent, 0.5637, 1e-4);
    EXPECT_NEAR(s.low_percent, 0.5008, 2e-4); // 95 %, computed with another program
    EXPECT_NEAR(s.high_percent, 0.6344, 2e-4);
    EXPECT_NEAR(share_of(0, 1000).high_percent, 0.3, 1e-12);
    EXPECT_EQ(share_of(5, 5).high_percent, 100);
    EXPECT_EQ(share_of(0, 0).high_percent, 100);
}

TEST(Scorer, CountsTheFourKindsOfVerdict) {
    Scorer sut;
    for (std::int64_t k = 0; k < 100; ++k) {
        sut.add(said(k, k == 10 || k == 50));
    }
    sut.add(label(10, 5));
    sut.add(label(20, 5));
    sut.add(label(2000, 5)); // nobody judged it
    Score const s = sut.score();
    EXPECT_EQ(s.true_positives, 1U);
    EXPECT_EQ(s.false_negatives, 1U);
    EXPECT_EQ(s.false_positives, 1U);
    EXPECT_EQ(s.true_negatives, 97U);
    EXPECT_EQ(s.labels_without_verdict, 1U);
    EXPECT_NEAR(s.false_positive.percent, 100.0 / 98, 1e-9);
    ASSERT_EQ(s.attacks.size(), 1U);
    EXPECT_EQ(s.attacks[0].labels, 3U);
    EXPECT_EQ(s.attacks[0].detected.count, 1U);
    EXPECT_EQ(s.attacks[0].delay_samples, 0);
}

TEST(Scorer, FakesWithinTwiceTheThresholdAreNotHeldAgainstADetector) {
    Scorer sut;
    sut.add(said(1, true));
    sut.add(said(2, false));
    sut.add(label(1, 5));
    sut.add(label(2, 0.5));
    Score const s = sut.score();
    EXPECT_EQ(s.attacks[0].detected.percent, 50);
    EXPECT_EQ(s.attacks[0].clear_detected.percent, 100);
    EXPECT_EQ(s.attacks[0].clear_detected.of, 1U);
}

TEST(Scorer, TellsAttacksApartAndMeasuresTheDelay) {
    Scorer sut;
    for (std::int64_t k = 0; k < 50; ++k) {
        sut.add(said(k, k == 25));
        if (k >= 20 && k < 30) {
            sut.add(label(k, 1, "ramp"));
        }
        if (k >= 40) {
            sut.add(label(k, 1, "bias"));
        }
    }
    Score const s = sut.score();
    ASSERT_EQ(s.attacks.size(), 2U);
    EXPECT_EQ(s.attacks[0].attack, "bias");
    EXPECT_FALSE(s.attacks[0].seen);
    EXPECT_EQ(s.attacks[0].delay_samples, -1);
    EXPECT_EQ(s.attacks[1].delay_samples, 5);
}

TEST(ScoreTrips, TellsRightLateAndFalseTripsApart) {
    TripScore const s = score_trips({{100, 200}, {500, 600}}, {50, 110, 120, 650});
    EXPECT_EQ(s.tripped, 1U);
    EXPECT_EQ(s.late_or_blocked, 1U);
    EXPECT_EQ(s.false_trips, 2U);
    EXPECT_EQ(s.delays, (std::vector<std::int64_t>{10}));
}

} // namespace
} // namespace gridspace::ids

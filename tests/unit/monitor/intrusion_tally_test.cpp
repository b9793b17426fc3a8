// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/stream/intrusion_tally.hpp"

#include "ids/scoring/scorer.hpp"

#include <cmath>
#include <gmock/gmock.h>
#include <random>
#include <set>

namespace gridspace::stream {
namespace {

constexpr std::uint8_t kAll = 0b111;

TEST(IntrusionTally, KnowsNoShareBeforeAnythingWasJudged) {
    IntrusionTally sut;
    EXPECT_TRUE(std::isnan(sut.counts().false_positive_percent()));
    EXPECT_TRUE(std::isnan(sut.counts().detected_percent()));
    sut.verdict(0, {}); // no forecast yet
    EXPECT_EQ(sut.counts().judged, 0U);
}

TEST(IntrusionTally, CountsEachFlaggedPhaseOfAHealthySampleOnce) {
    IntrusionTally sut;
    for (std::uint64_t i = 0; i < 100; ++i) {
        sut.verdict(i, {kAll, i == 7 ? std::uint8_t{0b011} : std::uint8_t{0}}); // two phases of one sample
    }
    sut.verdict(7, {kAll, 0b011}); // it came twice
    EXPECT_DOUBLE_EQ(sut.counts().false_positive_percent(), 200.0 / 300);
}

TEST(IntrusionTally, TakesAFlaggedFakeForADetectionAndNotForAFalsePositive) {
    IntrusionTally sut;
    for (std::uint64_t i = 0; i < 100; ++i) {
        sut.verdict(i, {kAll, i == 7 ? std::uint8_t{1} : std::uint8_t{0}});
    }
    sut.label(7, 0);
    sut.label(7, 0); // it came twice
    EXPECT_DOUBLE_EQ(sut.counts().false_positive_percent(), 0);
    EXPECT_DOUBLE_EQ(sut.counts().detected_percent(), 100);
    sut.label(8, 1); // and nobody has seen this one
    EXPECT_DOUBLE_EQ(sut.counts().detected_percent(), 50);
}

TEST(IntrusionTally, DoesNotTakeAFlagOfAnotherPhaseForADetection) {
    IntrusionTally sut;
    sut.verdict(7, {kAll, 0b100});
    sut.label(7, 0);
    EXPECT_DOUBLE_EQ(sut.counts().detected_percent(), 0);
    EXPECT_DOUBLE_EQ(sut.counts().false_positive_percent(), 50); // of the two phases that nobody touched
}

TEST(IntrusionTally, CountsTheOpenLoopByItself) {
    IntrusionTally sut;
    for (std::uint64_t i = 0; i < 10; ++i) {
        sut.verdict(i, {1, i < 4, i < 2}); // the closed loop is led astray by the sample before
    }
    EXPECT_DOUBLE_EQ(sut.counts().open_loop_false_positive_percent(), 20);
    sut.label(0, 0);
    EXPECT_DOUBLE_EQ(sut.counts().open_loop_false_positive_percent(), 100.0 / 9);
    EXPECT_DOUBLE_EQ(sut.counts().false_positive_percent(), 300.0 / 9);
    sut.label(10, 0); // and one that is judged later
    sut.verdict(10, {1, 1, 1});
    EXPECT_DOUBLE_EQ(sut.counts().open_loop_false_positive_percent(), 100.0 / 9);
}

TEST(IntrusionTally, SaysWhichFakesNobodyHasJudged) {
    IntrusionTally sut;
    sut.label(7, 0);
    sut.label(8, 0);
    EXPECT_EQ(sut.counts().unscored(), 2U);
    EXPECT_TRUE(std::isnan(sut.counts().detected_percent()));
    sut.verdict(7, {kAll, 1});
    sut.verdict(8, {}); // without a forecast
    EXPECT_EQ(sut.counts().unscored(), 1U);
    EXPECT_DOUBLE_EQ(sut.counts().detected_percent(), 100);
}

/// The report counts afterwards, from everything.
TEST(IntrusionTally, AgreesWithTheReportWhetherLabelsOrVerdictsComeFirst) {
    std::mt19937 random{11}; // NOLINT: repeatable on purpose
    auto const below = [&](std::uint32_t n) { return random() % n; };
    constexpr std::uint64_t kSamples = 20'000;
    std::vector<IntrusionTally::Phases> said(kSamples);
    std::set<std::pair<std::uint64_t, std::uint8_t>> fakes;
    ids::Scorer report;
    for (std::uint64_t i = 0; i < kSamples; ++i) {
        auto const some = [&](std::uint32_t often) {
            return below(often) == 0 ? static_cast<std::uint8_t>(below(8)) : std::uint8_t{0};
        };
        said[i] = {static_cast<std::uint8_t>(kAll & ~some(30)), some(50), some(70)};
        for (std::uint8_t p = 0; p < 3; ++p) {
            auto const bit = [&](std::uint8_t phases) { return ((phases >> p) & 1U) != 0; };
            auto const index = static_cast<std::int64_t>(i);
            if (bit(said[i].judged)) {
                report.add(
                    ids::ScoredVerdict{"s", index, p, 0, 0, 0, 0, bit(said[i].flagged), bit(said[i].open_flagged)});
            }
            if (below(120) == 0) {
                fakes.insert({i, p});
                report.add(ids::ScoredLabel{"attack", "s", index, p, 0, 0});
            }
        }
    }
    ids::Score const score = report.score();
    for (int const delay : {-5000, -3, 0, 3, 5000}) { // of the labels, in samples
        IntrusionTally sut;
        for (std::int64_t i = -6000; i < static_cast<std::int64_t>(kSamples) + 6000; ++i) {
            std::int64_t const labelled = i - delay;
            for (std::uint8_t p = 0; p < 3 && labelled >= 0; ++p) {
                if (fakes.contains({static_cast<std::uint64_t>(labelled), p})) {
                    sut.label(static_cast<std::uint64_t>(labelled), p);
                }
            }
            if (i >= 0 && i < static_cast<std::int64_t>(kSamples)) {
                sut.verdict(static_cast<std::uint64_t>(i), said[static_cast<std::size_t>(i)]);
            }
        }
        EXPECT_EQ(sut.counts().detected, score.true_positives) << delay;
        EXPECT_EQ(sut.counts().false_positives(), score.false_positives) << delay;
        EXPECT_EQ(sut.counts().unscored(), score.labels_without_verdict) << delay;
        EXPECT_DOUBLE_EQ(sut.counts().false_positive_percent(), score.false_positive.percent) << delay;
        EXPECT_DOUBLE_EQ(sut.counts().open_loop_false_positive_percent(), score.open_false_positive.percent) << delay;
    }
}

} // namespace
} // namespace gridspace::stream

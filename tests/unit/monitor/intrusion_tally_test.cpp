// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/stream/intrusion_tally.hpp"

#include <cmath>
#include <gmock/gmock.h>
#include <random>
#include <set>

namespace gridspace::stream {
namespace {

TEST(IntrusionTally, KnowsNoShareBeforeAnythingWasJudged) {
    IntrusionTally sut;
    EXPECT_TRUE(std::isnan(sut.counts().false_positive_percent()));
    EXPECT_TRUE(std::isnan(sut.counts().detected_percent()));
    sut.verdict(0, false, 0); // no forecast yet
    EXPECT_EQ(sut.counts().judged, 0U);
}

TEST(IntrusionTally, CountsAFlaggedHealthySampleAsAFalsePositiveOnce) {
    IntrusionTally sut;
    for (std::uint64_t i = 0; i < 100; ++i) {
        sut.verdict(i, true, i == 7 ? 0b011 : 0); // two phases of one sample
    }
    sut.verdict(7, true, 0b011); // it came twice
    EXPECT_DOUBLE_EQ(sut.counts().false_positive_percent(), 1);
}

TEST(IntrusionTally, TakesAFlaggedFakeForADetectionAndNotForAFalsePositive) {
    IntrusionTally sut;
    for (std::uint64_t i = 0; i < 100; ++i) {
        sut.verdict(i, true, i == 7 ? 1 : 0);
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
    sut.verdict(7, true, 0b100);
    sut.label(7, 0);
    EXPECT_DOUBLE_EQ(sut.counts().detected_percent(), 0);
    EXPECT_EQ(sut.counts().forged_flagged, 1U); // and neither for a false positive
}

TEST(IntrusionTally, CountsTheOpenLoopByItself) {
    IntrusionTally sut;
    for (std::uint64_t i = 0; i < 10; ++i) {
        sut.verdict(i, true, i < 4 ? 1 : 0, i < 2); // the closed loop is led astray by the sample before
    }
    EXPECT_DOUBLE_EQ(sut.counts().open_loop_false_positive_percent(), 20);
    sut.label(0, 0);
    EXPECT_DOUBLE_EQ(sut.counts().open_loop_false_positive_percent(), 100.0 / 9);
    EXPECT_DOUBLE_EQ(sut.counts().false_positive_percent(), 300.0 / 9);
    sut.label(10, 0); // and one that is judged later
    sut.verdict(10, true, 1, true);
    EXPECT_DOUBLE_EQ(sut.counts().open_loop_false_positive_percent(), 100.0 / 9);
}

TEST(IntrusionTally, SaysWhichFakesNobodyHasJudged) {
    IntrusionTally sut;
    sut.label(7, 0);
    sut.label(8, 0);
    EXPECT_EQ(sut.counts().unscored, 2U);
    EXPECT_TRUE(std::isnan(sut.counts().detected_percent()));
    sut.verdict(7, true, 1);
    sut.verdict(8, false, 0); // without a forecast
    EXPECT_EQ(sut.counts().unscored, 1U);
    EXPECT_DOUBLE_EQ(sut.counts().detected_percent(), 100);
}

/// The oracle counts afterwards, from sets.
TEST(IntrusionTally, DoesNotDependOnWhetherLabelsOrVerdictsComeFirst) {
    std::mt19937 random{11}; // NOLINT: repeatable on purpose
    auto const below = [&](std::uint32_t n) { return random() % n; };
    constexpr std::uint64_t kSamples = 20'000;
    std::vector<std::uint8_t> flagged(kSamples);
    std::set<std::pair<std::uint64_t, std::uint8_t>> fakes;
    for (std::uint64_t i = 0; i < kSamples; ++i) {
        flagged[i] = below(50) == 0 ? static_cast<std::uint8_t>(below(8)) : std::uint8_t{0};
        if (below(40) == 0) {
            fakes.insert({i, static_cast<std::uint8_t>(below(3))});
        }
    }
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
                sut.verdict(static_cast<std::uint64_t>(i), true, flagged[static_cast<std::size_t>(i)]);
            }
        }
        std::uint64_t false_positives = 0, healthy = 0, detected = 0;
        for (std::uint64_t i = 0; i < kSamples; ++i) {
            bool forged = false;
            for (std::uint8_t p = 0; p < 3; ++p) {
                if (fakes.contains({i, p})) {
                    forged = true;
                    detected += (flagged[i] >> p) & 1U;
                }
            }
            healthy += forged ? 0 : 1;
            false_positives += !forged && flagged[i] != 0 ? 1 : 0;
        }
        EXPECT_EQ(sut.counts().detected, detected) << delay;
        EXPECT_EQ(sut.counts().unscored, 0U) << delay;
        EXPECT_DOUBLE_EQ(sut.counts().false_positive_percent(),
                         100.0 * static_cast<double>(false_positives) / static_cast<double>(healthy))
            << delay;
    }
}

} // namespace
} // namespace gridspace::stream

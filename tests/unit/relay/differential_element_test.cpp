// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/differential_element.hpp"

#include "tests/unit/relay/waves.hpp"

#include <gtest/gtest.h>

namespace gridspace::relay {
namespace {

using Kind = ElementParams::Kind;

ElementParams params(Kind kind, double pickup_a = 30, double slope_percent = 30, int samples_per_cycle = 80) {
    ElementParams p;
    p.kind = kind;
    p.pickup_a = pickup_a;
    p.slope_percent = slope_percent;
    p.samples_per_cycle = p.window_samples = samples_per_cycle;
    return p;
}

/// Fills a window with two steady sinusoids, both counted into the line.
ElementValues steady(ElementParams const& p, double from_rms, double from_deg, double to_rms, double to_deg) {
    DifferentialElement sut{p};
    for (int k = 0; k < p.window_samples; ++k) {
        sut.push(wave(from_rms, from_deg, k, p.samples_per_cycle), wave(to_rms, to_deg, k, p.samples_per_cycle));
    }
    EXPECT_TRUE(sut.full());
    return sut.evaluate();
}

TEST(DifferentialElement, MeasuresTheRmsOfASinusoidAtSixtyAndFiftyHertz) {
    for (int const samples : {80, 96, 256}) {
        for (Kind const kind : {Kind::rms, Kind::phasor}) {
            ElementValues const v = steady(params(kind, 30, 30, samples), 100, 20, 40, 110);
            for (std::size_t phase = 0; phase < 3; ++phase) {
                EXPECT_NEAR(v.from_a[phase], 100, 1e-10);
                EXPECT_NEAR(v.to_a[phase], 40, 1e-10);
            }
        }
    }
}

TEST(DifferentialElement, PhasorSumIsTheVectorSum) {
    ElementValues const v = steady(params(Kind::phasor), 100, 20, 40, 110);
    EXPECT_NEAR(v.differential_a[1], std::hypot(100, 40), 1e-9);
    EXPECT_NEAR(v.restraint_a[1], 70, 1e-9);
}

TEST(DifferentialElement, RmsIsBlindToAFaultThatBothEndsFeedAlikeAndPhasorIsNot) {
    // 200 A into the line from both ends: 400 A in the fault, no difference of magnitudes.
    EXPECT_EQ(steady(params(Kind::rms), 200, 0, 200, 0).pickup_phases, 0);
    EXPECT_EQ(steady(params(Kind::phasor), 200, 0, 200, 0).pickup_phases, 7);
    // The published table of magnitudes at 95 % of the line, islanded: 21 A of difference, 213 A of true current.
    EXPECT_EQ(steady(params(Kind::rms), 117, 0, 96, 0).pickup_phases, 0);
    EXPECT_EQ(steady(params(Kind::phasor), 117, 0, 96, 0).pickup_phases, 7);
}

TEST(DifferentialElement, ThroughCurrentNeverPicksUp) {
    for (Kind const kind : {Kind::rms, Kind::phasor}) {
        ElementValues const v = steady(params(kind), 500, 0, 500, 180);
        EXPECT_EQ(v.pickup_phases, 0);
        EXPECT_NEAR(v.differential_a[0], 0, 1e-9);
    }
}

TEST(DifferentialElement, PicksUpExactlyWhenTheDifferenceReachesThePickup) {
    EXPECT_EQ(steady(params(Kind::rms, 29.999), 80, 0, 50, 180).pickup_phases, 7);
    EXPECT_EQ(steady(params(Kind::rms, 30.001), 80, 0, 50, 180).pickup_phases, 0);
}

TEST(DifferentialElement, RestraintRaisesWhatTheDifferenceHasToReach) {
    // 500 A through with 10 % of CT error: 50 A of difference, 475 A of restraint.
    EXPECT_EQ(steady(params(Kind::phasor, 30, 30), 500, 0, 450, 180).pickup_phases, 0);
    EXPECT_EQ(steady(params(Kind::phasor, 30, 5), 500, 0, 450, 180).pickup_phases, 7);
    ElementParams two = params(Kind::phasor, 30, 5);
    two.slope2_from_a = 200;
    two.slope2_percent = 60;
    ElementValues const v = steady(two, 500, 0, 450, 180);
    EXPECT_NEAR(v.operate_at_a[0], 0.05 * 200 + 0.6 * 275, 1e-9);
    EXPECT_EQ(v.pickup_phases, 0);
}

TEST(DifferentialElement, PhasorRejectsHarmonicsAndASteadyOffset) {
    DifferentialElement sut{params(Kind::phasor, 1, 0)};
    for (int k = 0; k < 80; ++k) {
        Abc i = wave(10, 0, k);
        Abc const third = wave(3, 40, 3 * k), fifth = wave(2, 10, 5 * k);
        for (std::size_t p = 0; p < 3; ++p) {
            i[p] += third[p] + fifth[p] + 7;
        }
        sut.push(i, {});
    }
    EXPECT_NEAR(sut.evaluate().differential_a[0], 10, 1e-9);
}

TEST(DifferentialElement, ASpikeLeavesNoTraceWhenItHasLeftTheWindow) {
    DifferentialElement sut{params(Kind::rms)}, clean{params(Kind::rms)};
    sut.push({1e9, 1e9, 1e9}, {});
    for (int k = 0; k < 80; ++k) {
        sut.push(wave(10, 0, k), wave(10, 180, k));
        clean.push(wave(10, 0, k), wave(10, 180, k));
    }
    EXPECT_EQ(sut.evaluate(), clean.evaluate());
}

TEST(WholeSamples, AcceptsWholeWindowsAndNamesTheOthers) {
    EXPECT_EQ(whole_samples(4800, 60, 1), 80);
    EXPECT_EQ(whole_samples(4800, 50, 1), 96);
    EXPECT_EQ(whole_samples(4000, 50, 1), 80);
    EXPECT_EQ(whole_samples(4800, 60, Rational(1, 2)), 40);
    EXPECT_EQ(whole_samples(14400, 60, 2), 480);
    auto const broken = whole_samples(4000, 60, 1);
    ASSERT_FALSE(broken);
    EXPECT_EQ(broken.error().message, "a window of 1 cycles of 60 Hz is 200/3 samples at 4000 Hz, not a whole number");
    EXPECT_FALSE(whole_samples(4800, 0, 1));
    EXPECT_FALSE(whole_samples(4800, 60, Rational(1, 80)));
}

} // namespace
} // namespace gridspace::relay

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/frequency_estimator.hpp"
#include "agents/relay/functions/phasor_estimator.hpp"
#include "agents/relay/functions/polarising_memory.hpp"
#include "tests/unit/relay/functions/signals.hpp"

#include <gtest/gtest.h>

namespace gridspace::relay {
namespace {

constexpr double kPi = std::numbers::pi;

Phasors estimate(Phasors const& p, double hz, double relative, double offset_cycles = 0, double nominal_hz = 60) {
    int const n = static_cast<int>(kRateHz / nominal_hz);
    PhasorEstimator sut{{n, offset_cycles * n}};
    sut.set_frequency(relative);
    for (int k = -1; k < n; ++k) { // the window begins at 0
        sut.push(at(p, hz, k / kRateHz));
    }
    EXPECT_TRUE(sut.full());
    Phasors out = sut.phasors();
    for (Complex& one : out) { // back from the middle of the window to its begin
        one *= polar(1, -360 * hz * (n - 1) / 2 / kRateHz);
    }
    return out;
}

TEST(PhasorEstimator, GivesMagnitudeAndAngleAtTheNominalFrequency) {
    Phasors const p{polar(100, 0), polar(50, -100), polar(7, 130)};
    for (double const offset_cycles : {0.0, 2.0}) {
        Phasors const seen = estimate(p, 60, 1, offset_cycles);
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(std::abs(seen[k] - p[k]), 0, 1e-10);
        }
    }
}

TEST(PhasorEstimator, IsExactAwayFromTheNominalFrequencyWhenItKnowsIt) {
    Phasors const p{polar(100, 20), polar(50, -100), polar(7, 130)}; // unbalanced: each phase for itself
    for (double const hz : {45.0, 57.3, 59.9, 63.0, 66.0}) {
        for (double const offset_cycles : {0.0, 2.0}) {
            Phasors const seen = estimate(p, hz, hz / 60, offset_cycles);
            for (std::size_t k = 0; k < 3; ++k) {
                EXPECT_NEAR(std::abs(seen[k] - p[k]), 0, 1e-9) << hz;
            }
        }
    }
    // The control: by the nominal frequency it is wrong.
    EXPECT_GT(std::abs(estimate(p, 57.3, 1)[0] - p[0]), 1);
}

TEST(PhasorEstimator, RejectsHarmonicsAndADecayingOffset) {
    PhasorEstimator plain{{80, 0}}, mimic{{80, 160}};
    for (int k = -1; k < 80; ++k) {
        double const t = k / kRateHz;
        double const wave = 100 * std::numbers::sqrt2 * std::cos(2 * kPi * 60 * t + 1) +
                            30 * std::cos(2 * kPi * 300 * t) + 20 * std::cos(2 * kPi * 420 * t + 2);
        double const offset = -100 * std::numbers::sqrt2 * std::cos(1.0) * std::exp(-t / (2.0 / 60));
        plain.push({wave, wave + offset, 0});
        mimic.push({wave, wave + offset, 0});
    }
    EXPECT_NEAR(std::abs(plain.phasors()[0]), 100, 1e-9);
    EXPECT_NEAR(std::abs(mimic.phasors()[0]), 100, 1e-9);
    EXPECT_NEAR(std::abs(mimic.phasors()[1]), 100, 0.1);
    EXPECT_GT(std::fabs(std::abs(plain.phasors()[1]) - 100), 3); // the control: what the offset does without
}

FrequencyParams frequency_params() {
    FrequencyParams p;
    p.nominal_hz = 60;
    return p;
}

/// Feeds `seconds` of a balanced voltage whose frequency is `hz` + `slope` t.
void feed(FrequencyEstimator& sut, double hz, double slope, double seconds, double negative = 0) {
    PhasorEstimator window{{80, 0}};
    for (int k = 0; k < static_cast<int>(seconds * kRateHz); ++k) {
        double const t = k / kRateHz;
        double const angle = 360 * (hz * t + slope * t * t / 2);
        Phasors const p = balanced(polar(100, angle)), n = balanced(std::conj(polar(negative, -angle)));
        window.push(at({p[0] + n[0], p[1] + n[2], p[2] + n[1]}, 0, 0));
        if (window.full()) {
            window.set_frequency(sut.steady());
            sut.push(sequence_of(window.phasors()).positive);
        }
    }
}

TEST(FrequencyEstimator, MeasuresASteadyFrequency) {
    for (double const hz : {50.0, 57.0, 59.99, 60.0, 61.5, 66.0}) {
        FrequencyEstimator sut{frequency_params()};
        feed(sut, hz, 0, 0.4);
        ASSERT_TRUE(sut.has_frequency());
        EXPECT_NEAR(sut.hz(), hz, 1e-6);
        EXPECT_NEAR(sut.hz_per_s(), 0, 1e-5);
    }
}

TEST(FrequencyEstimator, MeasuresAnUnbalancedOneToMillihertz) {
    FrequencyEstimator sut{frequency_params()};
    feed(sut, 59.2, 0, 0.6, 20);
    EXPECT_NEAR(sut.hz(), 59.2, 2e-3);
}

TEST(FrequencyEstimator, MeasuresTheRateOfARamp) {
    for (double const slope : {-2.0, -0.5, 1.0}) {
        FrequencyEstimator sut{frequency_params()};
        feed(sut, 60, slope, 1);
        ASSERT_TRUE(sut.has_rate());
        EXPECT_NEAR(sut.hz_per_s(), slope, 0.01);
        EXPECT_NEAR(sut.hz(), 60 + slope * (1 - 2 / 60.0), 2e-2); // in the middle of its window
    }
}

TEST(FrequencyEstimator, HasNoneOfADeadLineAndKeepsTheSteadyOneThroughAJump) {
    FrequencyParams p = frequency_params();
    p.minimum = 10;
    FrequencyEstimator sut{p};
    feed(sut, 59, 0, 0.4);
    sut.push(polar(100, 77)); // the angle jumps, as in a fault
    EXPECT_NEAR(sut.steady(), 59 / 60.0, 1e-6);
    sut.push(polar(1, 0));
    EXPECT_FALSE(sut.has_frequency());
}

TEST(PolarisingMemory, TurnsTheOldVoltageOnAndHoldsItWhenTheVoltageIsGone) {
    PolarisingMemory sut{80, 10, 480};
    double const step = 360 * 59.0 / kRateHz;
    Complex const turn = polar(1, step), two = polar(1, 160 * step);
    int k = 0;
    for (; k < 200; ++k) {
        sut.push(polar(100, k * step), turn, two);
    }
    for (; k < 200 + 480; ++k) {
        sut.push(polar(1, 0), turn, two);
        ASSERT_NEAR(std::abs(sut.voltage() - polar(100, k * step)), 0, 1e-6);
    }
    sut.push(polar(1, 0), turn, two); // longer than it holds
    EXPECT_FALSE(sut.has_voltage());
}

} // namespace
} // namespace gridspace::relay

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/effect_time.hpp"

#include <gtest/gtest.h>

namespace gridspace::bus {
namespace {

// Ticks of 40 steps of 1/48000 s (four samples of 4800 Hz); the tick that is worked on is (960, 1000].
constexpr SimTime kNow{1000};
constexpr SimSpan kTick{40}, kLatency{44};

SimTime in_lockstep(SimTime input, SimSpan latency = kLatency) {
    return effect_time(ClockMode::lockstep, input, kNow, kTick, latency);
}

TEST(EffectTime, InLockstepIsALatencyAfterTheInputWhereverInTheTickThatIs) {
    for (std::int64_t const quanta : {961, 970, 999, 1000}) {
        EXPECT_EQ(in_lockstep({quanta}), SimTime{quanta + 44});
    }
}

TEST(EffectTime, InLockstepDoesNotDependOnTheLengthOfTheTick) {
    // The same input at 985, in the tick (980, 990] of one sample and in the tick (960, 1000] of four.
    EXPECT_EQ(effect_time(ClockMode::lockstep, {985}, {990}, SimSpan{10}, kLatency), in_lockstep({985}));
}

TEST(EffectTime, InLockstepIsNotInThePastForInputsOfTicksThatAreOver) {
    EXPECT_EQ(in_lockstep({300}), SimTime{960 + 44});
    EXPECT_EQ(in_lockstep({960}), SimTime{960 + 44});
    EXPECT_GE(in_lockstep({300}, SimSpan{0}) + kTick, kNow);
}

TEST(EffectTime, InLockstepOfAnInputThatIsKnownBeforeItsTimeComesAfterThat) {
    EXPECT_EQ(in_lockstep({1010}), SimTime{1010 + 44});
}

TEST(EffectTime, InRealTimeIsNowWhateverTheInputAndTheLatency) {
    for (std::int64_t const quanta : {0, 300, 999, 1010}) {
        EXPECT_EQ(effect_time(ClockMode::realtime, {quanta}, kNow, kTick, kLatency), kNow);
        EXPECT_EQ(effect_time(ClockMode::realtime, {quanta}, kNow, kTick, SimSpan{0}), kNow);
    }
}

} // namespace
} // namespace gridspace::bus

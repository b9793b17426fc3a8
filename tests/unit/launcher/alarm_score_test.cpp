// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/alarm_score.hpp"

#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

std::vector<AttackSpan> const kAttacks{{"first", "bias", "A", 1.0, 1.5}, {"second", "injection", "G", 3.0, 3.2}};

TEST(AlarmScore, AnAlarmIsAboutTheAttackDuringWhichItBegins) {
    auto const sut =
        score_alarms(kAttacks, {{1.002, 1.1, "ids.r"}, {1.001, 1.3, "first_line.b"}, {3.23, 3.3, "x"}}, 10);
    ASSERT_EQ(sut.attacks.size(), 2U);
    EXPECT_NEAR(*sut.attacks[0].delay_ms, 1, 1e-9) << "the earlier one of two";
    EXPECT_EQ(sut.attacks[0].by, "first_line.b");
    EXPECT_NEAR(*sut.attacks[1].delay_ms, 230, 1e-9) << "30 ms after its end it is still about it";
    EXPECT_EQ(sut.alarms, 3U);
    EXPECT_EQ(sut.false_alarms, 0U);
}

TEST(AlarmScore, AnAlarmBeforeOrLongAfterAnAttackIsFalse) {
    auto const sut = score_alarms(kAttacks, {{0.999, 1.2, "x"}, {1.55, 1.6, "x"}, {9, 12, "x"}}, 10);
    EXPECT_FALSE(sut.attacks[0].delay_ms) << "it stood already";
    EXPECT_FALSE(sut.attacks[1].delay_ms);
    EXPECT_EQ(sut.false_alarms, 3U);
    EXPECT_NEAR(sut.genuine_s, 10 - 0.54 - 0.24, 1e-9);
    EXPECT_NEAR(sut.false_s, 0.001 + 0.05 + 1, 1e-9) << "until the end of the run, and not while somebody attacks";
}

TEST(AlarmScore, AnAlarmThatBeginsDuringOneAttackIsNotAboutThatBeforeIt) {
    std::vector<AttackSpan> const two{{"a", "bias", "A", 1, 2}, {"b", "injection", "G", 2.01, 3}};
    auto const sut = score_alarms(two, {{2.02, 2.5, "x"}}, 4);
    EXPECT_FALSE(sut.attacks[0].delay_ms);
    EXPECT_NEAR(*sut.attacks[1].delay_ms, 10, 1e-9);
    auto const between = score_alarms(two, {{2.005, 2.5, "x"}}, 4);
    EXPECT_TRUE(between.attacks[0].delay_ms);
    EXPECT_FALSE(between.attacks[1].delay_ms);
}

TEST(AlarmScore, AlarmsThatOverlapAreOneTimeAndAttacksToo) {
    std::vector<AttackSpan> const two{{"a", "bias", "A", 1, 2}, {"b", "bias", "B", 1.5, 3}};
    auto const sut = score_alarms(two, {{0, 1, "x"}, {0.5, 4, "y"}}, 4);
    EXPECT_NEAR(sut.genuine_s, 4 - 2.04, 1e-9);
    EXPECT_NEAR(sut.false_s, 4 - 2.04, 1e-9);
}

TEST(RaisedAlarms, AStateThatIsRepeatedIsNoNewAlarmAndTheLastOneLastsUntilTheEnd) {
    auto const sut = raised_alarms({{0, false}, {1, true}, {2, true}, {3, false}, {4, true}}, "x", 5);
    ASSERT_EQ(sut.size(), 2U);
    EXPECT_EQ(sut[0].from_s, 1);
    EXPECT_EQ(sut[0].to_s, 3);
    EXPECT_EQ(sut[1].to_s, 5);
}

TEST(RaisedAlarms, OnlySignalsOfDetectorsAndOfFirstLineRulesAreAlarms) {
    SignalStore const signals{{"ids.r.alarm", {"", {0, 1'000'000'000}, {0, 1}}},
                              {"ids.r.alarm_reasons", {"", {0}, {5}}},
                              {"node.alarm", {"", {0}, {1}}}};
    auto const sut = raised_alarms(signals, 2);
    ASSERT_EQ(sut.size(), 1U);
    EXPECT_EQ(sut[0].by, "ids.r");
    EXPECT_EQ(sut[0].from_s, 1);
}

} // namespace
} // namespace gridspace::launcher

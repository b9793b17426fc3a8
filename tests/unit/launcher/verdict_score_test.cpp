// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/score/verdict_score.hpp"

#include "common/random.hpp"

#include <array>
#include <cmath>

#include <gmock/gmock.h>

namespace gridspace::score {
namespace {

using testing::HasSubstr;

Extent const kExtent{{{"A", 4800}, {"B", 4800}}, {{"MU_A", "A"}}, 1, ""};

std::optional<Verdicts> parse(std::string const& text, std::string* said = nullptr,
                              std::optional<double> threshold = {}) {
    config::Diagnostics diagnostics;
    auto out = parse_verdicts(text, "v.csv", kExtent, threshold, diagnostics);
    if (said != nullptr) {
        *said = diagnostics.render();
    }
    return out;
}

TEST(VerdictsFile, NamesASampleByItsNumberOrItsTimeAndAStreamByItsNameOrSvId) {
    auto const by_number = parse("stream, sample ,verdict,note\nMU_A,480,1,mine\n\n# later\nB,0,0,\n");
    ASSERT_TRUE(by_number);
    EXPECT_TRUE(by_number->all.at({"A", 480, 0}).flagged);
    EXPECT_FALSE(by_number->all.at({"B", 0, 0}).flagged);
    auto const by_time = parse("time_s,stream,phase,score\n0.1,A,b,0.7\n", nullptr, 0.7);
    ASSERT_TRUE(by_time);
    EXPECT_TRUE(by_time->all.at({"A", 480, 1}).flagged);
}

TEST(VerdictsFile, EachMistakeHasItsPlaceWhatWasFoundAndWhatIsExpected) {
    for (auto const& [text, place, what] : std::vector<std::array<std::string, 3>>{
             {"stream,sample\nA,1\n", "v.csv:1:1:", "no column 'verdict'"},
             {"sample,verdict\n1,1\n", "v.csv:1:1:", "no column 'stream'"},
             {"stream,verdict\nA,1\n", "v.csv:1:1:", "no column 'sample'"},
             {"stream,sample,score\nA,1,0.5\n", "v.csv:1:1:", "--threshold"},
             {"stream,sample,verdict,verdict\nA,1,1,1\n", "v.csv:1:23:", "twice"},
             {"stream,sample,verdict\nA,one,1\n", "v.csv:2:3:", "'one' is no number of a sample"},
             {"stream,sample,verdict\nA,4800,1\n", "v.csv:2:3:", "'4800' is outside the run"},
             {"stream,sample,verdict\nA,-1,1\n", "v.csv:2:3:", "'-1' is outside the run"},
             {"stream,time_s,verdict\nA,inf,1\n", "v.csv:2:3:", "'inf' is no time"},
             {"stream,sample,verdict\nA,1, 2\n", "v.csv:2:6:", "'2' is no verdict"},
             {"stream,sample,verdict\nA,1,1\nMU_A,1,0\n", "v.csv:3:6:", "has a verdict already"},
             {"stream,sample,verdict\nC,1,1\n", "v.csv:2:1:", "no stream of sampled values 'C'"},
             {"stream,sample,verdict\nA,1\n", "v.csv:2:3:", "2 cells"},
             {"stream,sample,phase,verdict\nA,1,d,1\n", "v.csv:2:5:", "'d' is no phase"},
             {"stream,sample,score\nA,1,nan\n", "v.csv:2:5:", "'nan' is no score"},
             {"time_s,alarm,verdict\n0,1,1\n", "v.csv:1:14:", "both 'alarm' and 'verdict'"},
             {"alarm\n1\n", "v.csv:1:1:", "no column 'time_s'"},
             {"time_s,alarm\n0.1,yes\n", "v.csv:2:5:", "'yes' is no state of an alarm"},
             {"time_s,alarm\n1.1,1\n", "v.csv:2:1:", "'1.1' is outside the run"},
             {"time_s,alarm\n0.1,1\n0.1,0\n", "v.csv:3:1:", "two rows at 0.1 s"},
             {"", "v.csv", "empty"},
             {"stream,sample,verdict\n", "v.csv", "no row"}}) {
        std::string said;
        bool const needs_threshold = what == "--threshold" || what.find("no score") == std::string::npos;
        EXPECT_FALSE(parse(text, &said, needs_threshold ? std::nullopt : std::optional{0.5})) << text;
        EXPECT_THAT(said, HasSubstr(place));
        EXPECT_THAT(said, HasSubstr(what));
    }
}

Truth attacked(std::int64_t from, std::int64_t until) {
    Truth out;
    out.extent = kExtent;
    for (std::int64_t i = from; i < until; ++i) {
        out.labels.push_back({"attack", "bias", "A", i, 0, 1, 2});
    }
    return out;
}

TEST(VerdictScore, CountsWhatHasNoVerdictAsMissedAndFindsTheDelay) {
    auto verdicts = parse("stream,sample,verdict\nA,99,1\nA,100,0\nA,102,1\nA,103,1\nA,200,0\n");
    auto const s = score_verdicts(attacked(100, 105), *verdicts, false, 1);
    EXPECT_EQ(s.quality.true_positives, 2U);
    EXPECT_EQ(s.quality.false_positives, 1U);
    EXPECT_EQ(s.quality.true_negatives, 1U);
    EXPECT_EQ(s.quality.false_negatives, 3U);
    EXPECT_EQ(s.altered_unjudged, 2U);
    EXPECT_DOUBLE_EQ(*s.quality.precision.value, 2.0 / 3);
    EXPECT_DOUBLE_EQ(*s.quality.recall.value, 2.0 / 5);
    EXPECT_DOUBLE_EQ(*s.quality.f1.value, 0.5);
    EXPECT_NEAR(*s.attacks.at(0).delay_ms, 2 / 4.8, 1e-9);
    ASSERT_EQ(s.kinds.size(), 1U);
    EXPECT_EQ(s.kinds[0].kind, "bias");
    EXPECT_EQ(s.kinds[0].seen, 1U);
    EXPECT_EQ(s.kinds[0].recall.count, 2U);
    EXPECT_EQ(s.kinds[0].recall.of, 5U);
    auto const whole = score_verdicts(attacked(100, 105), *verdicts, true, 1);
    EXPECT_EQ(whole.quality.true_negatives, 4800U - 5 - 1);
}

TEST(VerdictScore, RecallIsSaidByKindOfAttack) {
    auto verdicts = parse("stream,sample,phase,verdict\nA,100,a,1\nA,101,a,0\nA,200,a,0\nA,201,a,0\nA,300,a,1\n");
    Truth truth;
    truth.extent = kExtent;
    auto const label = [&](char const* attack, char const* kind, std::int64_t index, std::uint8_t channel) {
        truth.labels.push_back({attack, kind, "A", index, channel, 1, 2});
    };
    label("one", "bias", 100, 0);
    label("one", "bias", 101, 0);
    label("two", "bias", 200, 0);
    label("slow", "ramp", 201, 0);
    label("frames", "synch", 300, 3); // no current was altered, and verdicts by phase are about currents
    auto const s = score_verdicts(truth, *verdicts, false, 1);
    ASSERT_EQ(s.kinds.size(), 3U);
    EXPECT_EQ(s.kinds[0].attacks, 2U);
    EXPECT_EQ(s.kinds[0].seen, 1U);
    EXPECT_NEAR(s.kinds[0].recall.percent, 100.0 / 3, 1e-9);
    EXPECT_EQ(s.kinds[1].kind, "ramp");
    EXPECT_EQ(s.kinds[1].recall.count, 0U);
    EXPECT_EQ(s.quality.true_positives, 1U);
    EXPECT_EQ(s.quality.false_positives, 1U);
}

TEST(VerdictScore, AFlaggedSampleOfAnyStreamRaisesAnAlarmUntilNoneWasFlaggedForFortyMilliseconds) {
    auto const verdicts = parse("stream,sample,verdict\nA,480,1\nA,490,0\nB,600,1\nA,1200,1\n");
    auto const sut = alarms_of(*verdicts, kExtent);
    ASSERT_EQ(sut.size(), 2U);
    EXPECT_DOUBLE_EQ(sut[0].from_s, 0.1);
    EXPECT_DOUBLE_EQ(sut[0].to_s, 0.125 + 0.04);
    EXPECT_DOUBLE_EQ(sut[1].from_s, 0.25);
}

TEST(VerdictScore, AnAttackIsAlarmedByAnAlarmThatBeginsDuringItAndNotByOneThatStandsAlready) {
    Truth truth = attacked(480, 960);
    truth.attacks = {{"attack", "bias", "A", 0.1, 0.2}, {"message", "injection", "G", 0.5, 0.6}};
    auto const found = score_verdicts(truth, *parse("stream,sample,verdict\nA,485,1\n"), false, 1).alarms;
    ASSERT_EQ(found.attacks.size(), 1U) << "verdicts on samples do not speak of messages";
    EXPECT_NEAR(*found.attacks[0].delay_ms, 5 / 4.8, 1e-9);
    auto const standing = score_verdicts(truth, *parse("stream,sample,verdict\nA,479,1\nA,485,1\n"), false, 1);
    EXPECT_FALSE(standing.alarms.attacks[0].delay_ms);
    EXPECT_TRUE(standing.attacks[0].score.seen) << "the sample was flagged";
    EXPECT_EQ(standing.alarms.false_alarms, 1U);
}

TEST(VerdictsFile, AListOfAlarmsMayBeEmpty) {
    auto const sut = parse("time_s,alarm\n");
    ASSERT_TRUE(sut);
    EXPECT_TRUE(alarms_of(*sut, kExtent).empty());
    auto const one = parse("alarm,time_s\n1,0.25\n0,0.5\n");
    ASSERT_TRUE(one);
    ASSERT_EQ(alarms_of(*one, kExtent).size(), 1U);
    EXPECT_EQ(alarms_of(*one, kExtent)[0].to_s, 0.5);
}

/// Random scores with ties: altered ones are higher on the whole.
std::vector<ids::Judgement> random_judgements() {
    Random random{3};
    std::vector<ids::Judgement> out;
    for (std::uint32_t i = 0; i < 600; ++i) {
        bool const altered = random.chance(0.2);
        double const score = std::round(10 * (random.uniform() + (altered ? 0.3 : 0))) / 10;
        out.push_back({i / 20, altered, score > 0.8, score});
    }
    return out;
}

TEST(VerdictQuality, TheAreaBelowTheRocIsTheShareOfPairsInTheRightOrder) {
    auto const judgements = random_judgements();
    double right = 0, pairs = 0;
    for (auto const& a : judgements) {
        for (auto const& b : judgements) {
            if (a.altered && !b.altered) {
                right += a.score > b.score ? 1 : a.score == b.score ? 0.5 : 0;
                pairs += 1;
            }
        }
    }
    auto const q = ids::verdict_quality(judgements, true, 1);
    EXPECT_NEAR(*q.auc.value, right / pairs, 1e-12);
    EXPECT_LT(*q.auc.low, *q.auc.value);
    EXPECT_GT(*q.auc.high, *q.auc.value);
    double area = 0, x = 0, y = 0; // the trapezoids below its points
    for (auto const& p : q.roc) {
        area += (p.false_positive_rate - x) * (p.recall + y) / 2;
        x = p.false_positive_rate;
        y = p.recall;
    }
    EXPECT_NEAR(area, *q.auc.value, 1e-12);
    EXPECT_EQ(x, 1);
    EXPECT_EQ(y, 1);
}

TEST(VerdictQuality, TheSameSeedGivesTheSameIntervalsAndAnotherOneOthers) {
    auto const judgements = random_judgements();
    auto const once = ids::verdict_quality(judgements, true, 1), again = ids::verdict_quality(judgements, true, 1),
               other = ids::verdict_quality(judgements, true, 2);
    EXPECT_EQ(once.auc.low, again.auc.low);
    EXPECT_EQ(once.f1.high, again.f1.high);
    EXPECT_NE(once.auc.low, other.auc.low);
}

/// The same bootstrap by the definition: the judgements of the blocks that were drawn, one by one.
std::pair<double, double> interval_by_definition(std::vector<ids::Judgement> const& judgements, std::uint32_t blocks) {
    Random random{1, "bootstrap"};
    std::vector<double> areas;
    for (int k = 0; k < 1000; ++k) {
        std::vector<double> times(blocks);
        for (std::uint32_t b = 0; b < blocks; ++b) {
            times[random.below(blocks)] += 1;
        }
        double right = 0, pairs = 0;
        for (auto const& a : judgements) {
            for (auto const& b : judgements) {
                if (a.altered && !b.altered) {
                    double const weight = times[a.block] * times[b.block];
                    right += weight * (a.score > b.score ? 1 : a.score == b.score ? 0.5 : 0);
                    pairs += weight;
                }
            }
        }
        areas.push_back(right / pairs);
    }
    std::sort(areas.begin(), areas.end());
    return {areas[24], areas[974]};
}

TEST(VerdictQuality, TheIntervalOfTheAreaIsThatOfTheDefinitionAndHardlyAnotherWhenItsCostIsBounded) {
    Random random{5};
    std::vector<ids::Judgement> judgements;
    for (std::uint32_t i = 0; i < 300; ++i) {
        bool const altered = random.chance(0.2);
        double const score = random.normal() + (altered ? 1.0 : 0.0) + (i % 3 == 0 ? 0.0 : std::round(random.normal()));
        judgements.push_back({i / 20, altered, false, score});
    }
    auto const [low, high] = interval_by_definition(judgements, 15);
    auto const q = ids::verdict_quality(judgements, true, 1);
    EXPECT_NEAR(*q.auc.low, low, 1e-12);
    EXPECT_NEAR(*q.auc.high, high, 1e-12);
    auto const bounded = ids::verdict_quality(judgements, true, 1, 1000, 200);
    EXPECT_EQ(bounded.auc.value, q.auc.value);
    EXPECT_NEAR(*bounded.auc.low, low, 0.01);
    EXPECT_NEAR(*bounded.auc.high, high, 0.01);
    EXPECT_NE(bounded.auc.low, q.auc.low) << "control: nothing was put together";
}

TEST(VerdictQuality, WhatCannotBeCountedHasNoFigure) {
    auto const q = ids::verdict_quality({{0, false, false, 0}}, true, 1);
    EXPECT_FALSE(q.precision.value);
    EXPECT_FALSE(q.recall.value);
    EXPECT_FALSE(q.auc.value);
    EXPECT_EQ(q.false_positive_rate.value, 0);
}

} // namespace
} // namespace gridspace::score

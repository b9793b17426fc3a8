// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "launcher/judge/expectation.hpp"

#include <gmock/gmock.h>

namespace gridspace::launcher {
namespace {

using testing::HasSubstr;
using Status = ExpectationResult::Status;

constexpr std::int64_t kSecond = 1'000'000'000;

/// 0, 1, 2 … at whole seconds, and a state that is 1 from 3 s to 5 s and from 8 s on.
SignalStore signals() {
    SignalStore out;
    for (int t = 0; t <= 10; ++t) {
        out["ramp.R.value"].times_ns.push_back(t * kSecond);
        out["ramp.R.value"].values.push_back(t);
        out["ramp.Q.value"].times_ns.push_back(t * kSecond);
        out["ramp.Q.value"].values.push_back(10 - t);
    }
    out["state.S.on"] = {"", {0, 3 * kSecond, 5 * kSecond, 8 * kSecond}, {0, 1, 0, 1}};
    return out;
}

ExpectationResult judged(std::string const& settings, SignalStore const& store = signals(),
                         Moments const& moments = {{"fault", 4}}) {
    config::Diagnostics diagnostics;
    std::string const text = "e: " + settings;
    auto const node = config::parse_yaml(text, config::make_source("e.yaml", text), diagnostics);
    auto const list = read_expectations(*node, diagnostics);
    EXPECT_TRUE(diagnostics.ok()) << diagnostics.render();
    EXPECT_EQ(list.size(), 1U);
    return list.empty() ? ExpectationResult{} : judge(list[0], store, moments, 10);
}

TEST(Judge, AlwaysAndNeverAndEventuallyLookAtEveryChange) {
    EXPECT_EQ(judged("{always: ramp.R.value <= 10}").status, Status::passed);
    EXPECT_EQ(judged("{always: ramp.R.value < 10}").status, Status::failed);
    EXPECT_EQ(judged("{never: ramp.R.value > 10}").status, Status::passed);
    EXPECT_EQ(judged("{never: ramp.R.value == 7}").status, Status::failed);
    EXPECT_EQ(judged("{eventually: ramp.R.value == 7}").status, Status::passed);
    EXPECT_EQ(judged("{eventually: ramp.R.value == 7.5}").status, Status::failed);
    EXPECT_EQ(judged("{always: ramp.R.value + ramp.Q.value == 10}").status, Status::passed);
}

TEST(Judge, ADelayBelowZeroIsNotMeasurableAndMeetsNothing) {
    SignalStore store;
    store["relay.r.sample_to_decision_ms"] = {"ms", {0, kSecond, 2 * kSecond}, {2, -199.8, -196.9}};
    store["stream.S.wire_delay_ms"] = {"ms", {0}, {0.2}};
    store["stream.Q.wire_delay_ms"] = {"ms", {0}, {-0.2}};

    for (char const* settings :
         {"{p99_of: relay.r.sample_to_decision_ms, below: 3}", "{mean_of: relay.r.sample_to_decision_ms, below: 3}",
          "{always: relay.r.sample_to_decision_ms <= 3}", "{max_of: stream.*.wire_delay_ms, below: 3}"}) {
        ExpectationResult const sut = judged(settings, store);
        EXPECT_EQ(sut.status, Status::failed) << settings;
        EXPECT_EQ(sut.value, std::nullopt) << settings;
        EXPECT_THAT(sut.detail, HasSubstr("not measurable: ")) << settings;
    }
    EXPECT_THAT(judged("{p99_of: relay.r.sample_to_decision_ms, below: 3}", store).detail,
                HasSubstr("relay.r.sample_to_decision_ms is below 0 (-199.8 ms) at 1 s"));
    EXPECT_EQ(judged("{p99_of: stream.S.wire_delay_ms, below: 3}", store).status, Status::passed);
    EXPECT_EQ(judged("{max_of: relay.r.sample_to_decision_ms, below: 3, until: fault - 3.5 s}", store).status,
              Status::passed);
    EXPECT_EQ(judged("{min_of: relay.r.sample_to_decision_ms, between: [-200, 3]}", store).value, -199.8)
        << "asked for";
}

TEST(Judge, WindowsBeginAndEndAtEvents) {
    EXPECT_EQ(judged("{always: ramp.R.value >= 4, from: fault}").status, Status::passed);
    EXPECT_EQ(judged("{always: ramp.R.value >= 5, from: fault}").status, Status::failed);
    EXPECT_EQ(judged("{always: ramp.R.value <= 6, until: fault + 2 s}").status, Status::passed);
    EXPECT_EQ(judged("{always: ramp.R.value <= 5, until: fault + 2 s}").status, Status::failed);
}

TEST(Judge, StatisticsAreOfAllValuesInTheWindow) {
    EXPECT_EQ(judged("{min_of: ramp.*.value, above: -1}").value, 0);
    EXPECT_EQ(judged("{max_of: ramp.R.value, below: 11}").value, 10);
    EXPECT_EQ(judged("{mean_of: ramp.R.value, is: 5, tolerance: 0.01}").value, 5);
    EXPECT_EQ(judged("{median_of: ramp.R.value, is: 5, tolerance: 0.01}").value, 5);
    EXPECT_EQ(judged("{p99_of: ramp.R.value, is: 10, tolerance: 0.01}").value, 10);
    EXPECT_EQ(judged("{last_of: ramp.Q.value, is: 0, tolerance: 0.01}").value, 0);
    EXPECT_EQ(judged("{min_of: ramp.R.value, above: 0}").status, Status::failed); // above is exclusive
    EXPECT_EQ(judged("{min_of: ramp.R.value, at_least: 0}").status, Status::passed);
}

TEST(Judge, TimesAreThoseOfTheFirstFulfilmentInTheUnitThatIsWanted) {
    EXPECT_EQ(judged("{time_of: ramp.R.value >= 6, unit: s, is: 6, tolerance: 0.1}").value, 6);
    EXPECT_EQ(judged("{time_of: ramp.R.value >= 6, unit: ms, is: 6000, tolerance: 1}").value, 6000);
    EXPECT_DOUBLE_EQ(*judged("{time_of: ramp.R.value >= 9, unit: h, is: 0.0025, tolerance: 0.0001}").value, 0.0025);
    auto const never = judged("{time_of: ramp.R.value >= 11, unit: s, is: 6, tolerance: 100}");
    EXPECT_EQ(never.status, Status::failed);
    EXPECT_FALSE(never.value);
}

TEST(Judge, CountsEdges) {
    EXPECT_EQ(judged("{count_of: state.S.on rises, is: 2, tolerance: 0}").status, Status::passed);
    EXPECT_EQ(judged("{count_of: state.S.on falls, is: 1, tolerance: 0}").status, Status::passed);
    EXPECT_EQ(judged("{count_of: state.S.on rises, at_least: 3}").status, Status::failed);
}

TEST(Judge, ASignalThatWasNotRecordedFailsAndSaysSo) {
    auto const sut = judged("{always: ramp.X.value > 0}");
    EXPECT_EQ(sut.status, Status::failed);
    EXPECT_NE(sut.detail.find("ramp.X.value"), std::string::npos);
    EXPECT_EQ(judged("{always: ramp.R.value >= 0}", {}).status, Status::failed);
}

TEST(Judge, AnEventThatNeverCameFailsAndSaysSo) {
    auto const sut = judged("{always: ramp.R.value >= 0, from: trip}", signals(), {});
    EXPECT_EQ(sut.status, Status::failed);
    EXPECT_NE(sut.detail.find("trip"), std::string::npos) << sut.detail;
}

TEST(Judge, NothingHoldsAfterTheEndOfTheRun) {
    Moments const moments{{"fault", 4}, {"later", 1800}};
    for (char const* verb :
         {"always: ramp.R.value >= 0", "never: ramp.R.value < 0", "eventually: ramp.R.value >= 0",
          "min_of: ramp.R.value, at_least: 0", "mean_of: ramp.R.value, at_least: 0",
          "last_of: ramp.R.value, at_least: 0", "last_of: ramp.R.value + 1, at_least: 0",
          "count_of: state.S.on rises, is: 0, tolerance: 0", "time_of: ramp.R.value >= 0, at_least: 0"}) {
        for (char const* from : {"later", "fault + 3 h"}) {
            auto const sut = judged(std::string{"{"} + verb + ", from: " + from + "}", signals(), moments);
            EXPECT_EQ(sut.status, Status::failed) << verb << " from " << from;
            EXPECT_EQ(sut.value, std::nullopt) << verb;
        }
    }
    EXPECT_EQ(judged("{min_of: ramp.R.value, at_least: 0, from: fault + 2 h}").detail,
              "the run ended at 10 s, before 'fault + 7200 s'");
    EXPECT_EQ(judged("{time_of: state.S.on == 1, since: later, below: 5}", signals(), moments).status, Status::failed);
    EXPECT_EQ(judged("{last_of: ramp.R.value, at_least: 0, from: later, show_only: true}", signals(), moments).status,
              Status::shown);
    EXPECT_EQ(judged("{last_of: ramp.R.value, is: 10, tolerance: 0, from: fault + 6 s}").status, Status::passed)
        << "the end itself belongs to the run";
    EXPECT_EQ(judged("{never: ramp.R.value > 10, until: later}", signals(), moments).status, Status::passed)
        << "as far as the run went";
}

TEST(Judge, AWindowThatEndsBeforeItBeginsIsNoWindow) {
    auto const sut = judged("{min_of: ramp.R.value, at_least: 0, from: fault, until: fault - 1 s}");
    EXPECT_EQ(sut.status, Status::failed);
    EXPECT_EQ(sut.detail, "'fault - 1 s' is at 3 s, before 'fault'");
}

TEST(Judge, NothingIsCountedWhereNothingWasRecordedYet) {
    SignalStore store = signals();
    store["late.L.on"] = {"", {9 * kSecond}, {0}};
    auto const sut = judged("{count_of: late.L.on rises, is: 0, tolerance: 0, until: fault}", store);
    EXPECT_EQ(sut.status, Status::failed);
    EXPECT_EQ(sut.detail, "no values in that time");
}

TEST(Judge, WhatWasTrueBeforeTheEventIsNoAnswerToIt) {
    Moments const moments{{"fault", 4}, {"open", 3}, {"second", 6}};
    for (char const* window : {"since: fault", "from: fault, since: fault"}) {
        auto const sut =
            judged(std::string{"{time_of: state.S.on == 1, unit: ms, below: 20, "} + window + "}", signals(), moments);
        EXPECT_EQ(sut.status, Status::failed) << window;
        EXPECT_EQ(sut.detail, "was already true at 3 s, before 'fault'") << window;
    }
    EXPECT_EQ(judged("{time_of: state.S.on == 1, from: fault, below: 5}", signals(), moments).value, 4)
        << "the first time of the window";
    EXPECT_EQ(judged("{time_of: state.S.on == 1, since: open, below: 1}", signals(), moments).value, 0)
        << "at the instant itself is not before";
    EXPECT_EQ(judged("{time_of: state.S.on rises, since: open, below: 1}", signals(), moments).value, 0);
    EXPECT_EQ(judged("{time_of: state.S.on == 1, since: second, below: 3}", signals(), moments).value, 2)
        << "the one after it counts, not the one before";
    EXPECT_EQ(judged("{time_of: state.S.on rises, since: fault, below: 5}", signals(), moments).value, 4)
        << "the next edge";
    EXPECT_EQ(judged("{time_of: state.S.on == 1, from: open - 1 s, since: fault, below: 5}", signals(), moments).status,
              Status::failed);
    EXPECT_EQ(judged("{time_of: state.S.on == 1, since: fault, between: [-2, 0]}", signals(), moments).value, -1)
        << "that is what was asked";
    EXPECT_EQ(judged("{time_of: ramp.R.value >= 0, below: 1}").value, 0) << "true from the start";
}

TEST(Judge, ADivisionByZeroFulfilsNothing) {
    for (char const* settings : {"{last_of: ramp.R.value / 0, above: 1}", "{max_of: 1 / ramp.R.value, above: 1}",
                                 "{p99_of: 1 / ramp.R.value, above: 0}", "{always: 1 / ramp.R.value > 0.01}",
                                 "{never: 0 / ramp.R.value > 1}", "{eventually: ramp.R.value / 0 > 1000}"}) {
        auto const sut = judged(settings);
        EXPECT_EQ(sut.status, Status::failed) << settings;
        EXPECT_THAT(sut.detail, HasSubstr("division by zero")) << settings;
    }
    EXPECT_THAT(judged("{always: 1 / ramp.R.value > 0.01}").detail, HasSubstr("at 0 s"));
    EXPECT_EQ(judged("{always: ramp.R.value == 0 or 1 / ramp.R.value > 0.01}").status, Status::passed)
        << "it does not divide there";
    EXPECT_EQ(judged("{last_of: 1 / ramp.R.value, is: 0.1, tolerance: 0.001}").status, Status::passed)
        << "the last value is one";
}

TEST(Judge, ShowsWithoutJudgingWhenAsked) {
    auto const sut = judged("{max_of: ramp.R.value, show_only: true}");
    EXPECT_EQ(sut.status, Status::shown);
    EXPECT_EQ(sut.value, 10);
}

} // namespace
} // namespace gridspace::launcher

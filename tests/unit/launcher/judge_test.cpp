// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "launcher/expect/expectation.hpp"

#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

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

TEST(Judge, ShowsWithoutJudgingWhenAsked) {
    auto const sut = judged("{max_of: ramp.R.value, show_only: true}");
    EXPECT_EQ(sut.status, Status::shown);
    EXPECT_EQ(sut.value, 10);
}

} // namespace
} // namespace gridspace::launcher

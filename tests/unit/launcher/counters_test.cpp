// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "launcher/judge/counters.hpp"

#include <gmock/gmock.h>

namespace gridspace::launcher {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Status = ExpectationResult::Status;

constexpr std::int64_t kSecond = 1'000'000'000;
std::map<std::string, std::set<std::string>> const kPublished{{"relay1", {"stream.S.lost", "relay.relay1.trip"}}};
std::vector<LoggedEvent> const kRestart{{2.4, "launcher", "again", "relay1 restarted"}};

ExpectationResult judged(std::string const& settings, SignalStore const& store, CounterGaps const& gaps) {
    config::Diagnostics diagnostics;
    std::string const text = "e: " + settings;
    auto const node = config::parse_yaml(text, config::make_source("e.yaml", text), diagnostics);
    auto const list = read_expectations(*node, diagnostics);
    EXPECT_TRUE(diagnostics.ok()) << diagnostics.render();
    ExpectationResult out = judge(list.at(0), store, {}, 10);
    mind_gaps(list.at(0), gaps, out);
    return out;
}

TEST(Counters, GoOnWhereTheirProcessWasStartedAgain) {
    SignalStore signals;
    signals["stream.S.lost"] = {"", {0, kSecond, 2 * kSecond, 3 * kSecond, 4 * kSecond}, {0, 5, 60, 1, 3}};
    signals["relay.relay1.trip"] = {"", {0, kSecond, 3 * kSecond}, {0, 1, 0}};

    CounterGaps const sut = continue_counters(signals, kPublished, kRestart);

    EXPECT_THAT(signals["stream.S.lost"].values, ElementsAre(0, 5, 60, 61, 63));
    EXPECT_THAT(signals["relay.relay1.trip"].values, ElementsAre(0, 1, 0)) << "a state";
    ASSERT_EQ(sut.size(), 1U);
    EXPECT_EQ(sut.at("stream.S.lost").at(0).to_string(), "what relay1 counted from 2 s to 2.4 s");
}

TEST(Counters, GoOnEvenIfTheNewOneHasSoonCountedMore) {
    SignalStore signals;
    signals["stream.S.lost"] = {"", {0, kSecond, 3 * kSecond}, {0, 5, 70}};

    static_cast<void>(continue_counters(signals, kPublished, kRestart));

    EXPECT_THAT(signals["stream.S.lost"].values, ElementsAre(0, 5, 75));
}

TEST(Counters, ARowOfTheVeryInstantIsTheOldOnesUnlessItFalls) {
    for (double const at_the_instant : {60.0, 0.0}) {
        SignalStore signals;
        signals["stream.S.lost"] = {"", {0, kSecond, 2 * kSecond, 3 * kSecond}, {0, 50, at_the_instant, 4}};

        CounterGaps const sut = continue_counters(signals, kPublished, {{2, "launcher", "again", "relay1 restarted"}});

        EXPECT_EQ(signals["stream.S.lost"].values.back(), at_the_instant > 0 ? 64 : 54);
        EXPECT_EQ(sut.empty(), at_the_instant > 0) << "all of it was told";
    }
}

TEST(Counters, WhatWentWithAProcessMeetsNoUpperLimit) {
    SignalStore signals;
    signals["stream.S.lost"] = {"", {0, 3 * kSecond}, {0, 0}};
    CounterGaps const gaps = continue_counters(signals, kPublished, kRestart);

    for (char const* settings : {"{last_of: \"stream.S*.lost\", is: 0}", "{max_of: stream.S.lost, below: 3}",
                                 "{always: stream.S.lost == 0}"}) {
        ExpectationResult const sut = judged(settings, signals, gaps);
        EXPECT_EQ(sut.status, Status::failed) << settings;
        EXPECT_THAT(sut.detail, HasSubstr("cannot be judged: what relay1 counted from 0 s to 2.4 s went with it"))
            << settings;
        EXPECT_EQ(sut.value, std::nullopt);
    }
    signals["stream.S.lost"].values = {0, 40};
    EXPECT_EQ(judged("{last_of: stream.S.lost, at_least: 40}", signals, gaps).status, Status::passed)
        << "it was no less";
    EXPECT_EQ(judged("{last_of: stream.S.lost, is: 0}", signals, gaps).value, 40) << "it was no less";
    EXPECT_EQ(judged("{last_of: stream.S.lost, is: 40}", signals, {}).status, Status::passed);
}

TEST(Counters, AKilledProcessCountsNoMoreAndItsLastWordsAreMissed) {
    SignalStore signals;
    signals["stream.S.lost"] = {"", {0}, {0}};

    CounterGaps const sut = continue_counters(signals, kPublished, {{0.4, "launcher", "end", "relay1 killed"}});

    EXPECT_EQ(sut.at("stream.S.lost").at(0).until_s, 0.4);
    EXPECT_TRUE(continue_counters(signals, kPublished, {}).empty());
}

} // namespace
} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/consequences.hpp"

#include "common/config/yaml.hpp"

#include <gtest/gtest.h>
#include <tuple>

namespace gridspace::launcher {
namespace {

config::Node yaml(std::string const& text) {
    config::Diagnostics diagnostics;
    auto out = config::parse_yaml(text, config::make_source("x.yaml", text), diagnostics);
    EXPECT_TRUE(out) << diagnostics.render();
    return out ? *out : config::Node::map();
}

constexpr std::int64_t kS = 1'000'000'000;

config::Node const& network() {
    static config::Node const out = yaml("loads: {L1: {bus: B, p_kw: 4}, L2: {bus: B, p_kw: 2, scale: day}}\n");
    return out;
}

/// A load of 4 kW that gets `kw` from 10 s to 20 s of 30.
SignalStore supplied(double kw) {
    return {{"load.L1.p_kw", {"kW", {0, 10 * kS, 20 * kS}, {3.9, kw, 3.9}}}};
}

TEST(Consequences, ALoadInTheDarkIsNotServed) {
    auto const sut = find_consequences({}, yaml("attacks: {}\n"), network(), supplied(0), 30);
    EXPECT_DOUBLE_EQ(sut.load_not_served_kw, 4);
    EXPECT_NEAR(sut.energy_not_served_wh, 4000.0 * 10 / 3600, 1e-9);
    ASSERT_EQ(sut.loads.size(), 1U);
    EXPECT_EQ(sut.loads[0].load, "L1");
    EXPECT_EQ(sut.unknown, std::vector<std::string>{"L2"}) << "a profile decides what it asks for";
}

TEST(Consequences, ALoadAtALowVoltageIsServed) {
    EXPECT_EQ(find_consequences({}, yaml("attacks: {}\n"), network(), supplied(2.4), 30).energy_not_served_wh, 0);
    EXPECT_GT(find_consequences({}, yaml("attacks: {}\n"), network(), supplied(1.9), 30).energy_not_served_wh, 0);
}

TEST(Consequences, WhatTheScenarioTakesAwayIsNotMissed) {
    char const* const off = "events: {off: {at_s: 10, disconnect: L1}, on: {at_s: 20, connect: L1}}\n";
    EXPECT_EQ(find_consequences({}, yaml(off), network(), supplied(0), 30).energy_not_served_wh, 0);
    char const* const more = "events: {more: {at_s: 10, set: {loads.L1.p_kw: 8}}}\n";
    auto const sut = find_consequences({}, yaml(more), network(), supplied(3.9), 30);
    EXPECT_NEAR(sut.load_not_served_kw, 4.1, 1e-9) << "less than half of what it asks for now";
    EXPECT_NEAR(sut.energy_not_served_wh, 4100.0 * 20 / 3600, 1e-9);
}

/// A relay trips on its fault at 1 s; its breaker's position is recorded.
std::uint64_t lost_with(std::vector<double> const& positions, double trip_s) {
    char const* const scenario = R"(
processes:
  relay: {program: gridspace-relay, currents: {from: A, to: B}, trip: TRIP}
  ied: {program: gridspace-breaker, from: TRIP.status, to: commands}
simulation: {gateways: {LINE: {subscribe: {commands: [CB1]}}}}
)";
    IntrusionScore score;
    IntrusionScore::Relay& relay = score.relays.emplace_back();
    relay.relay = "relay";
    relay.faults_s = {1};
    relay.trips_s = {trip_s};
    SignalStore signals;
    signals["breaker.CB1.position"] = {"", {0, kS + kS / 10}, positions};
    return find_consequences(score, yaml(scenario), network(), signals, 30).lost;
}

TEST(Consequences, ATripAfterWhichNoBreakerOpensIsLost) {
    EXPECT_EQ(lost_with({2, 2}, 1.01), 1U);
    EXPECT_EQ(lost_with({2, 1}, 1.01), 0U) << "it opens";
    EXPECT_EQ(lost_with({1, 1}, 1.01), 0U) << "it was open";
    EXPECT_EQ(lost_with({2, 2}, 0.5), 0U) << "no trip of this fault: the relay's own score says so";
}

TEST(Consequences, NothingIsSaidAboutLoadsThatNobodyRecorded) {
    auto const sut = find_consequences({}, yaml("attacks: {}\n"), network(), {}, 30);
    EXPECT_TRUE(sut.loads.empty());
    SignalStore signals;
    add_consequence_signals(sut, 30, signals);
    EXPECT_FALSE(signals.contains("consequence.energy_not_served_wh"));
    EXPECT_TRUE(signals.contains("consequence.trips_lost"));
}

IntrusionScore::Relay relay(std::uint64_t faults, std::uint64_t lost, std::vector<double> added_ms) {
    IntrusionScore::Relay out;
    out.with.real_faults = faults;
    out.with.late_or_blocked = lost;
    out.with.false_trips = 1;
    out.added_each_ms = std::move(added_ms);
    return out;
}

TEST(Consequences, TripsOfAllRelaysAreCounted) {
    IntrusionScore score;
    score.relays = {relay(3, 1, {0, 0.2}), relay(2, 0, {20, 0.22})};
    auto const sut = find_consequences(score, yaml("attacks: {}\n"), network(), {}, 30);
    EXPECT_EQ(sut.faults, 5U);
    EXPECT_EQ(sut.lost, 1U);
    EXPECT_EQ(sut.late, 2U);
    EXPECT_EQ(sut.compared, 4U);
    EXPECT_EQ(sut.false_trips, 2U);
}

TEST(Consequences, TheSlowestTripCountsFromItsFault) {
    IntrusionScore score;
    score.relays = {relay(2, 0, {})};
    score.relays[0].faults_s = {1, 2};
    score.relays[0].trips_s = {0.9, 1.002, 2.025};
    auto const sut = find_consequences(score, yaml("attacks: {}\n"), network(), {}, 30);
    ASSERT_TRUE(sut.slowest_trip_ms);
    EXPECT_NEAR(*sut.slowest_trip_ms, 25, 1e-9);
    score.relays[0].trips_s = {0.9, 1.7};
    EXPECT_FALSE(find_consequences(score, yaml("attacks: {}\n"), network(), {}, 30).slowest_trip_ms);
}

TEST(Consequences, ABreakerThatOpensWithoutAFaultIsNamed) {
    auto const position = [](std::int64_t opens_ms) { return SignalSeries{"", {0, opens_ms * 1'000'000}, {2, 1}}; };
    SignalStore const signals{{"breaker.CB1.position", position(1100)},
                              {"breaker.CB2.position", position(900)},
                              {"breaker.CB3.position", position(2001)},
                              {"breaker.CB4.position", position(2001)},
                              {"breaker.CB5.position", {"", {0}, {1}}}};
    auto const scenario = yaml("events: {fault: {at_s: 1, apply_fault: {line: L}}, off: {at_s: 2, open: [CB3]}}\n");
    auto const sut = find_consequences({}, scenario, network(), signals, 30);
    EXPECT_EQ(sut.opened_without_fault, (std::vector<std::string>{"CB2", "CB4"}));
}

TEST(Consequences, AreLookedForWhereSomebodyOrSomethingWorksAgainstTheRun) {
    EXPECT_TRUE(is_disturbed(yaml("attacks: {a: {by: x}}\n")));
    EXPECT_TRUE(is_disturbed(yaml("processes: {c: {program: gridspace-link}}\n")));
    EXPECT_TRUE(is_disturbed(yaml("events: {dies: {at_s: 1, kill: mu}}\n")));
    EXPECT_FALSE(is_disturbed(yaml("attacks: {}\nprocesses: {s: {program: gridspace-sim}}\n"
                                   "events: {f: {at_s: 1, open: [CB]}}\n")));
}

TEST(Consequences, AnAlarmCountsFromTheFirstThingThatWasAltered) {
    IntrusionScore score;
    auto const label = [&](char const* attack, char const* target, std::int64_t index, std::int64_t sent_ns) {
        IntrusionRecording::Label out;
        out.attack = attack;
        out.target = target;
        out.index = index;
        out.sent_ns = sent_ns;
        score.recording.labels.push_back(out);
    };
    label("values", "S", 480, 0);
    label("values", "S", 900, 0);
    label("over", "S", 480, 0);
    label("over", "S", 500, 0);
    label("messages", "G", 0, 2 * kS + 5'000'000);
    label("silent", "S", 4800 * 29, 0);
    auto const scenario = yaml("streams: {S: {kind: smv, rate_hz: 4800}, G: {kind: goose}}\n"
                               "attacks: {messages: {window: {from_s: 1.999}}}\n");
    SignalStore const signals{
        {"ids.r.alarm", {"", {0, kS / 20, kS / 10 + 5'000'000, kS / 5}, {0, 1, 0, 1}}},
        {"first_line.b.alarm", {"", {0, 2 * kS}, {0, 1}}},
        {"ids.r.alarms", {"", {0, kS / 10 + 1'000'000}, {0, 1}}},
    };
    auto const sut = find_consequences(score, scenario, network(), signals, 30);
    ASSERT_EQ(sut.alarms.attacks.size(), 4U);
    auto const& [messages, over, silent, values] =
        std::tie(sut.alarms.attacks[0], sut.alarms.attacks[1], sut.alarms.attacks[2], sut.alarms.attacks[3]);
    EXPECT_EQ(messages.by, "first_line.b");
    EXPECT_NEAR(*messages.delay_ms, 1, 1e-6) << "messages: not before the window, and not later than 10 ms";
    EXPECT_FALSE(over.delay_ms) << over.span.attack << ": 96 ms after the end is not about it";
    EXPECT_FALSE(silent.delay_ms);
    EXPECT_EQ(values.span.attack, "values");
    EXPECT_NEAR(*values.delay_ms, 100, 1e-6) << "the alarm that was up before is none of this attack";
    EXPECT_EQ(sut.alarms.alarms, 3U);
    EXPECT_EQ(sut.alarms.false_alarms, 1U) << "the one at 50 ms";
}

} // namespace
} // namespace gridspace::launcher

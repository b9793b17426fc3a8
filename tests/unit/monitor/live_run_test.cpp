// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/live_run.hpp"

#include "bus/codec.hpp"

#include <catalog.h>
#include <clock.h>
#include <gmock/gmock.h>
#include <intrusion.h>
#include <signals.h>
#include <statistics.h>

namespace gridspace::monitor {
namespace {

class LiveRunTest : public testing::Test {
  protected:
    template <class T>
    void hear(std::string const& topic, std::string const& type, std::string const& process, T const& sample) {
        bus::Codec const& codec = bus::codec_of<T>();
        std::vector<std::byte> cdr(codec.encoded_size(&sample));
        ASSERT_GT(codec.encode(&sample, cdr), 0U);
        sut_.on_sample("management", topic, type, process, cdr, 0);
    }
    void clock(std::uint64_t tick, std::int64_t time_ns, ClockState state = CLOCK_RUNNING) {
        SimClock sample;
        sample.tick(tick);
        sample.time_ns(time_ns);
        sample.state(state);
        hear("simulation_clock", "SimClock", "sim", sample);
    }
    void signal(std::string const& source, std::int64_t time_ns, double value) {
        SignalCatalog catalog;
        catalog.source(source.c_str());
        catalog.group("g");
        catalog.columns().resize(1);
        catalog.columns()[0].name((source + ".x.y").c_str());
        hear("signal_catalog", "SignalCatalog", source, catalog);
        SignalFrame frame;
        frame.source(source.c_str());
        frame.group("g");
        frame.times_ns({time_ns});
        frame.values({value});
        hear("signals", "SignalFrame", source, frame);
    }
    void verdicts(std::uint64_t first, std::vector<std::uint8_t> const& flags) {
        IdsVerdict sample;
        sample.detector("relay2");
        sample.stream("SMV21");
        sample.first_index(first);
        sample.rate_num(4800);
        sample.rate_den(1);
        for (std::uint8_t const f : flags) {
            SampleVerdict one;
            one.a().raw_a(5);
            one.a().forecast_a(4);
            one.a().flags(f);
            sample.samples().push_back(one);
        }
        sample.time_ns(static_cast<std::int64_t>(first + flags.size() - 1) * 1'000'000'000 / 4800);
        hear("verdicts_of_somebody", "IdsVerdict", "relay2", sample);
    }
    double newest(std::string const& name) {
        auto const [window, column] = sut_.find_signal(name);
        return window == nullptr ? NAN : window->newest(column);
    }

    LiveRun sut_{RunPlan{}};
};

TEST_F(LiveRunTest, KnowsTheTimeFromTheSimulatorsSignalsWhereTicksAreNotPublished) {
    clock(1, 1'000'000'000);
    EXPECT_DOUBLE_EQ(sut_.clock.time_s, 1);
    signal("sim", 3'000'000'000, 7);
    EXPECT_DOUBLE_EQ(sut_.clock.time_s, 3);
    ClockAck ack;
    ack.tick(3);
    hear("clock_ack", "ClockAck", "ev1", ack);
    EXPECT_EQ(sut_.clock.tick, 3U);
    signal("mcca", 9'000'000'000, 7); // others may be told of instants to come
    EXPECT_DOUBLE_EQ(sut_.clock.time_s, 3);
    clock(2, 2'000'000'000); // late
    EXPECT_DOUBLE_EQ(sut_.clock.time_s, 3);
}

TEST_F(LiveRunTest, MakesSignalsOfVerdictsAndCountsThemAgainstTheTruth) {
    std::vector<std::uint8_t> flags(10, VERDICT_JUDGED);
    flags[4] = VERDICT_JUDGED | VERDICT_FLAGGED;
    flags[6] = VERDICT_JUDGED | VERDICT_FLAGGED;
    verdicts(4800, flags);
    EXPECT_DOUBLE_EQ(newest("ids.relay2.SMV21.raw.a"), 5);
    EXPECT_DOUBLE_EQ(newest("ids.relay2.SMV21.forecast.a"), 4);
    EXPECT_DOUBLE_EQ(newest("ids.relay2.SMV21.false_positive_percent"), 20);
    auto const [window, column] = sut_.find_signal("ids.relay2.SMV21.flagged.a");
    ASSERT_NE(window, nullptr);
    EXPECT_EQ(window->value_at(column, 1'000'833'334), 1); // sample 4804
    EXPECT_EQ(window->value_at(column, 1'000'833'332), 0);
    AttackLabel label;
    label.target("SMV21");
    label.time_ns(1'001'000'000);
    label.values().resize(1);
    label.values()[0].index(4804);
    hear("attack_labels", "AttackLabel", "attacker", label);
    EXPECT_DOUBLE_EQ(newest("ids.relay2.SMV21.false_positive_percent"), 100.0 / 9);
    EXPECT_DOUBLE_EQ(newest("ids.relay2.SMV21.detected_percent"), 100);
    EXPECT_EQ(sut_.undecodable, 0U);
}

TEST_F(LiveRunTest, CountsNewestSamplesThatAreNotWhatTheirIdlSays) {
    using namespace std::chrono_literals;
    sut_.idl["Thing"] = "struct Thing { octet a; octet b; };";
    sut_.idl["Other"] = "@mutable struct Other { long a; };";
    auto const come = [&](char const* type, std::size_t octets) {
        std::vector<std::byte> cdr(4 + octets);
        sut_.on_sample("data", type, type, "p", cdr, 0);
        sut_.measure(1s);
        return sut_.undecodable;
    };
    EXPECT_EQ(come("Thing", 2), 0U);
    EXPECT_EQ(come("Thing", 1), 1U);
    sut_.measure(1s); // the same one
    EXPECT_EQ(sut_.undecodable, 1U);
    EXPECT_EQ(come("Thing", 2), 1U);
    EXPECT_EQ(come("Other", 1), 1U);   // that is not the sample's fault
    EXPECT_EQ(come("Unknown", 1), 1U); // nobody knows
}

TEST_F(LiveRunTest, KnowsFromTheEventLogWhoHasDied) {
    for (char const* name : {"ev1", "ev2", "ev3"}) {
        sut_.graph.participant_found("data", {std::string{"id of "} + name, {name, 0, "gridspace-ev"}, {}});
    }
    sut_.add_event({0, 1.5, "ev1", "exit", "killed by signal 9"});
    sut_.add_event({0, 1.5, "launcher", "cut_power", "ev3 killed"});
    std::map<std::string, graph::ProcessState> states;
    for (graph::Process const& process : sut_.snapshot().processes) {
        states[process.name] = process.state;
    }
    EXPECT_EQ(states["ev1"], graph::ProcessState::lost);
    EXPECT_EQ(states["ev2"], graph::ProcessState::alive);
    EXPECT_EQ(states["ev3"], graph::ProcessState::lost);
}

TEST_F(LiveRunTest, KeepsNoMoreOctetsOfATopicWhenItsSamplesGrow) {
    constexpr std::size_t kMax = 256 * 1024;
    auto const come = [&](std::size_t octets) {
        sut_.on_sample("data", "x", "Unknown", "p", std::vector<std::byte>(octets), 0);
        std::size_t kept = 0;
        for (RawSample const& sample : sut_.topics.at({"data", "x"}).newest) {
            kept += sample.cdr.size();
        }
        return kept;
    };
    auto const& newest = sut_.topics[{"data", "x"}].newest;
    for (int i = 0; i < 100; ++i) {
        ASSERT_LE(come(100), kMax);
    }
    EXPECT_EQ(newest.size(), 64U);
    for (int i = 0; i < 100; ++i) {
        ASSERT_LE(come(60'000), kMax) << i;
    }
    EXPECT_EQ(newest.size(), 4U);
    EXPECT_EQ(come(1'000'000), 1'000'000U) << "the newest is always kept";
    EXPECT_EQ(come(100), 100U);
    EXPECT_EQ(newest.back().number, 202U);
}

TEST_F(LiveRunTest, KeepsLargeSamplesOfSomeTopicsOnly) {
    constexpr std::size_t kLarge = 15U << 20U, kAll = 64U << 20U;
    for (int i = 0; i < 10; ++i) {
        sut_.on_sample("data", "x" + std::to_string(i), "Unknown", "p", std::vector<std::byte>(kLarge), 0);
        sut_.on_sample("data", "x" + std::to_string(i), "Unknown", "p", std::vector<std::byte>(kLarge), 0);
    }
    std::size_t kept = 0;
    for (auto const& [key, topic] : sut_.topics) {
        kept += topic.newest_octets;
        EXPECT_EQ(topic.samples, 2U);
    }
    EXPECT_GT(kept, kLarge);
    EXPECT_LE(kept, kAll);
    EXPECT_FALSE(sut_.events.empty());
}

TEST_F(LiveRunTest, KeepsABoundedLengthOfIdl) {
    TypeCatalogEntry entry;
    auto const said = [&](std::string const& type, std::size_t octets) {
        entry.type_name(type.c_str());
        entry.idl(std::string(octets, ' '));
        hear("type_catalog", "TypeCatalogEntry", "p", entry);
    };
    sut_.idl["T0"] = std::string(50'000, ' '); // of a configuration
    said("Long", 300'000);
    EXPECT_FALSE(sut_.idl.contains("Long"));
    for (int i = 0; i < 100; ++i) {
        said("T" + std::to_string(i), 200'000);
        said("T0", 100'000 + static_cast<std::size_t>(i)); // a newer text of one that is known
    }
    std::size_t kept = 0;
    for (auto const& [type, text] : sut_.idl) {
        kept += text.size();
    }
    EXPECT_LE(kept, 16U << 20U);
    EXPECT_GT(kept, 15U << 20U);
    EXPECT_EQ(sut_.idl.at("T0").size(), 100'099U);
}

TEST_F(LiveRunTest, CountsOnForTheStreamsThatItKnowsWhenThereIsNoRoomForMore) {
    StreamStatistics row;
    row.process("relay2");
    for (std::uint64_t frames : {1, 2}) {
        row.frames(frames);
        for (int i = 0; i < 5000; ++i) {
            row.stream(("S" + std::to_string(i)).c_str());
            hear("stream_statistics", "StreamStatistics", "relay2", row);
        }
    }
    EXPECT_EQ(sut_.stream_ends.size(), 4096U);
    EXPECT_EQ(sut_.stream_ends.at({"S0", "relay2"}).frames, 2U);
    EXPECT_FALSE(sut_.stream_ends.contains({"S4999", "relay2"}));
}

TEST_F(LiveRunTest, KeepsABoundedNumberOfNamesAndSaysSoOnce) {
    ClockAck acknowledgement;
    for (int i = 0; i < 5000; ++i) {
        std::string const name = "stranger" + std::to_string(i);
        signal(name, i, 1);
        acknowledgement.member(name.c_str());
        hear("clock_ack", "ClockAck", name, acknowledgement);
    }
    EXPECT_EQ(sut_.signals.size(), 256U);
    EXPECT_EQ(sut_.acknowledged.size(), 4096U);
    std::vector<std::string> said;
    for (RunEvent const& event : sut_.events) {
        said.push_back(event.event + ": " + event.text);
    }
    EXPECT_THAT(said, testing::ElementsAre(
                          "limit: there are more than 256 groups of signals on the bus: the others are not shown",
                          "limit: there are more than 4096 processes that acknowledge on the bus: the others are not "
                          "shown"));
}

TEST_F(LiveRunTest, CountsVerdictsThatAreNone) {
    sut_.on_sample("data", "ids_verdicts", "IdsVerdict", "relay2", std::vector<std::byte>(5), 0);
    sut_.on_sample("data", "attack_labels", "AttackLabel", "attacker", {}, 0);
    EXPECT_EQ(sut_.undecodable, 2U);
}

} // namespace
} // namespace gridspace::monitor

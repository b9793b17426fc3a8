// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/tick_length.hpp"

#include "common/config/yaml.hpp"
#include "launcher/scenario/scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

using testing::HasSubstr;

struct Device final : ProcessSettings {
    std::vector<TopicUse> written, read;
    std::vector<WireUse> sent, received;
    std::int64_t latency_us{0};
    bool promises{false}, ahead{false}, member{true};
    [[nodiscard]] std::vector<TopicUse> writes(Scenario const&, Process const&) const override { return written; }
    [[nodiscard]] std::vector<TopicUse> reads(Scenario const&, Process const&) const override { return read; }
    [[nodiscard]] std::vector<WireUse> sends(Scenario const&, Process const&) const override { return sent; }
    [[nodiscard]] std::vector<WireUse> receives(Scenario const&, Process const&) const override { return received; }
    [[nodiscard]] Rational latency_s(Process const&) const override { return {latency_us, 1'000'000}; }
    [[nodiscard]] Rational promises_s(Process const& p) const override { return promises ? latency_s(p) : Rational{0}; }
    [[nodiscard]] bool works_ahead() const override { return ahead; }
    [[nodiscard]] bool is_member() const override { return member; }
    [[nodiscard]] config::Node settings(Scenario const&, Process const&) const override { return config::Node::map(); }
};

Device& add(Scenario& s, std::string const& name, std::string_view program) {
    Process process;
    process.name = {name, {}};
    process.host = {"host_" + name, {}};
    process.program = {std::string{program}, {}};
    auto device = std::make_unique<Device>();
    Device& out = *device;
    process.settings = std::move(device);
    s.processes.push_back(std::move(process));
    return out;
}

/// sim -> mu (120 us) -> relay (900 us) -> breaker (1111.2 us) -> sim, at 4800 samples a second.
Scenario chain() {
    constexpr std::uint16_t kSv = 0x88ba, kGoose = 0x88b8;
    Scenario s;
    s.clock.mode = bus::ClockMode::lockstep;
    s.simulation.step_s = Rational{1, 48000};
    s.simulation.duration_s = Rational{8};
    config::Diagnostics diagnostics;
    constexpr std::string_view kSampling = "{rate_hz: 4800}";
    s.simulation.sampling = *config::parse_yaml(kSampling, config::make_source("sampling", kSampling), diagnostics);
    Device& sim = add(s, "sim", "gridspace-sim");
    sim.member = false;
    sim.written = {{.topic = "currents", .type = "LineCurrents"}};
    sim.read = {{.topic = "trips", .type = "TripCommand"}};
    Device& mu = add(s, "mu", "gridspace-mu");
    mu.read = {{.topic = "currents", .type = "LineCurrents", .triggers = true}};
    mu.sent = {{"bus", kSv, "", false}};
    mu.latency_us = 120;
    mu.promises = true;
    Device& relay = add(s, "relay", "gridspace-relay");
    relay.received = {{"bus", kSv, "", false}};
    relay.sent = {{"bus", kGoose, "", false}};
    relay.latency_us = 900;
    relay.promises = true;
    Device& breaker = add(s, "breaker", "gridspace-breaker");
    breaker.received = {{"bus", kGoose, "", false}};
    breaker.written = {{.topic = "trips", .type = "TripCommand"}};
    breaker.latency_us = 1112;
    breaker.ahead = true;
    return s;
}

std::string refusal(Scenario& s, std::int64_t samples) {
    s.clock.tick_samples = samples;
    config::Diagnostics diagnostics;
    check_loops(s, dataflow(s), diagnostics);
    return diagnostics.render();
}

TEST(TickLength, ATickMayBeAsLongAsTheLoopAndNotOnlyAsItsLastHop) {
    Scenario s = chain();
    EXPECT_EQ(refusal(s, 9), "");
    EXPECT_THAT(refusal(s, 10),
                HasSubstr("process 'breaker' acts on the simulator 2012 us after its input (relay 900 us, then breaker "
                          "1112 us), and a tick is 2083.33"));
}

TEST(TickLength, ALoopIsAsLongAsTheShortestWayIntoIt) {
    Scenario s = chain();
    add(s, "second", "gridspace-attacker").sent = {{"bus", 0x88b8, "", false}}; // promises nothing
    EXPECT_EQ(refusal(s, 5), "");
    EXPECT_THAT(refusal(s, 6), HasSubstr("breaker' acts on the simulator 1112 us after its input, and"));
}

TEST(TickLength, WhoHearsTheSimulatorItselfIsNoFurtherThanItsTick) {
    Scenario s = chain();
    dynamic_cast<Device&>(*s.processes.back().settings).read = {{.topic = "currents", .type = "LineCurrents"}};
    EXPECT_THAT(refusal(s, 6), HasSubstr("1112 us after its input, and"));
}

TEST(TickLength, WhereProcessesAreKilledTicksEndForEverybodyAtOneInstant) {
    Scenario s = chain();
    sim::Event kill;
    kill.name = {"kill_relay", {}};
    kill.at_s = Rational{1};
    kill.kill = {"relay", {}};
    s.events.push_back(kill);
    EXPECT_THAT(refusal(s, 9), HasSubstr("because events act on processes"));
    EXPECT_EQ(longest_tick_samples(s), 5);
}

TEST(TickLength, AutoTakesTheLongestThatDividesSecondsAndTheRun) {
    Scenario s = chain();
    EXPECT_EQ(longest_tick_samples(s), 8); // 9 would fit into the loop, and a second is no multiple of it
    s.simulation.duration_s = Rational{2411, 4800};
    EXPECT_EQ(longest_tick_samples(s), 1);
}

TEST(TickLength, MembersAreToldHowFarAheadTheyWorkWhereTheTickNeedsItAndOnlyThere) {
    Scenario s = chain();
    s.clock.tick_samples = 5;
    EXPECT_TRUE(work_ahead(s, dataflow(s)).ahead_s.empty());
    s.clock.tick_samples = 8;
    WorkAhead const found = work_ahead(s, dataflow(s));
    EXPECT_EQ(found.ahead_s.at("breaker"), (Rational{44, 48000})) << "900 us, rounded up to steps";
    EXPECT_EQ(found.promise_s.at("relay"), (Rational{44, 48000}));
    EXPECT_EQ(found.ahead_s.size() + found.promise_s.size(), 2U);
}

} // namespace
} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/bumps.hpp"

#include "gateways/iec61850/frame.hpp"
#include "launcher/scenario/dataflow.hpp"

#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint16_t kSv = iec61850::kSvEthertype, kGoose = iec61850::kGooseEthertype;

/// A device or a process in a cable, without a program behind it.
struct Device final : ProcessSettings {
    std::vector<WireUse> sent, received;
    std::vector<BumpUse> places;
    [[nodiscard]] std::vector<WireUse> sends(Scenario const&, Process const&) const override { return sent; }
    [[nodiscard]] std::vector<WireUse> receives(Scenario const&, Process const&) const override { return received; }
    [[nodiscard]] std::vector<BumpUse> bumps(Scenario const&, Process const&) const override { return places; }
    [[nodiscard]] config::Node settings(Scenario const&, Process const&) const override { return config::Node::map(); }
};

Device& add(Scenario& s, std::string const& name, std::string const& host) {
    Process process;
    process.name = {name, {}};
    process.host = {host, {}};
    auto device = std::make_unique<Device>();
    Device& out = *device;
    process.settings = std::move(device);
    s.processes.push_back(std::move(process));
    return out;
}

/// A merging unit and a relay on one bus.
Scenario two_devices() {
    Scenario s;
    s.clock.mode = bus::ClockMode::lockstep;
    for (char const* name : {"mu", "ied", "evil"}) {
        Host host;
        host.name = {name, {}};
        host.links = {{"bus", {}}};
        s.hosts.push_back(host);
    }
    Link link;
    link.name = {"bus", {}};
    s.links.push_back(link);
    add(s, "unit", "mu").sent = {{"bus", kSv, "SMV"}};
    Device& relay = add(s, "relay", "ied");
    relay.received = {{"bus", kSv, "SMV"}};
    relay.sent = {{"bus", kGoose, "TRIP"}};
    return s;
}

bus::MemberPlan const& member(Dataflow const& flow, std::string const& name) {
    return *std::find_if(flow.members.begin(), flow.members.end(), [&](auto const& m) { return m.name == name; });
}

TEST(BumpInTheWire, StandsBetweenItsHostAndEverybodyElse) {
    Scenario s = two_devices();
    add(s, "middle", "evil").places = {{{"mu", {}}, {"bus", {}}, true, false}};
    auto const sut = placed_bumps(s);
    ASSERT_EQ(sut.size(), 1U);
    ASSERT_TRUE(sut[0].from_host);
    EXPECT_FALSE(sut[0].to_host);
    EXPECT_EQ(sut[0].process_host, "evil");
    EXPECT_EQ(sut[0].from_host->in, "mu>bus");
    EXPECT_EQ(sut[0].from_host->out, "bus");
    EXPECT_THAT(sut[0].from_host->ethertypes, ElementsAre(kSv));
    Dataflow const flow = dataflow(s);
    EXPECT_THAT(member(flow, "middle").upstream, ElementsAre("unit"));
    EXPECT_THAT(member(flow, "relay").upstream, ElementsAre("middle"));
    EXPECT_THAT(member(flow, "relay").triggered_by, ElementsAre("middle"));
}

TEST(BumpInTheWire, BeforeTheReceiverLeavesTheSenderAlone) {
    Scenario s = two_devices();
    add(s, "middle", "evil").places = {{{"ied", {}}, {"bus", {}}, false, true}};
    EXPECT_EQ(piece_sent_on(s, "ied", "bus"), "bus");
    EXPECT_EQ(piece_received_on(s, "ied", "bus"), "bus>ied");
    EXPECT_EQ(piece_sent_on(s, "mu", "bus"), "bus");
    Dataflow const flow = dataflow(s);
    EXPECT_THAT(member(flow, "middle").upstream, ElementsAre("unit"));
    EXPECT_THAT(member(flow, "relay").upstream, ElementsAre("middle"));
}

TEST(BumpInTheWire, SeveralInOneCableFormAChainFromTheHostToTheSwitch) {
    Scenario s = two_devices();
    add(s, "first", "evil").places = {{{"mu", {}}, {"bus", {}}, true, false}};
    add(s, "second", "evil").places = {{{"mu", {}}, {"bus", {}}, true, false}};
    auto const sut = placed_bumps(s);
    ASSERT_EQ(sut.size(), 2U);
    EXPECT_EQ(sut[0].from_host->in, "mu>bus");
    EXPECT_EQ(sut[0].from_host->out, sut[1].from_host->in);
    EXPECT_EQ(sut[1].from_host->out, "bus");
    EXPECT_NE(sut[0].host_interface, sut[1].host_interface);
    Dataflow const flow = dataflow(s);
    EXPECT_THAT(member(flow, "second").upstream, ElementsAre("first"));
    EXPECT_THAT(member(flow, "relay").upstream, ElementsAre("second"));
}

TEST(BumpInTheWire, TwoProcessesShareACableByDirectionWithoutACircle) {
    Scenario s = two_devices();
    add(s, "out", "evil").places = {{{"ied", {}}, {"bus", {}}, true, false}};
    add(s, "in", "evil").places = {{{"ied", {}}, {"bus", {}}, false, true}};
    Dataflow const flow = dataflow(s);
    EXPECT_THAT(member(flow, "in").upstream, ElementsAre("unit"));
    EXPECT_THAT(member(flow, "relay").upstream, ElementsAre("in"));
    EXPECT_THAT(member(flow, "out").upstream, ElementsAre("relay"));
}

TEST(BumpInTheWire, ARecorderAtTheSwitchSeesWhatComesOutOfTheCable) {
    Scenario s = two_devices();
    add(s, "middle", "evil").places = {{{"mu", {}}, {"bus", {}}, true, false}};
    add(s, "recorder", "mu").received = {{"bus", kSv, "", true}};
    Dataflow const flow = dataflow(s);
    EXPECT_THAT(member(flow, "recorder").upstream, ElementsAre("middle"));
}

TEST(BumpInTheWire, NobodyInTheCableChangesNothing) {
    Scenario const s = two_devices();
    EXPECT_THAT(placed_bumps(s), IsEmpty());
    EXPECT_EQ(piece_sent_on(s, "mu", "bus"), "bus");
    EXPECT_THAT(member(dataflow(s), "relay").upstream, ElementsAre("unit"));
}

std::string said_about(Scenario const& s, std::string const& process) {
    config::Diagnostics diagnostics;
    check_bumps(s, *s.find_process(process), diagnostics);
    return diagnostics.render();
}

TEST(BumpInTheWire, MustBeInACableThatIsThere) {
    Scenario s = two_devices();
    Device& middle = add(s, "middle", "evil");
    middle.places = {{{"mu", {}}, {"bus", {}}, true, false}};
    EXPECT_EQ(said_about(s, "middle"), "");
    middle.places = {{{"mv", {}}, {"bus", {}}, true, false}};
    EXPECT_THAT(said_about(s, "middle"), testing::HasSubstr("did you mean 'mu'?"));
    middle.places = {{{"mu", {}}, {"bus", {}}, false, true}};
    EXPECT_THAT(said_about(s, "middle"), testing::HasSubstr("direction: from_host"));
    middle.places = {{{"evil", {}}, {"bus", {}}, true, false}};
    EXPECT_THAT(said_about(s, "middle"), testing::HasSubstr("its own host"));
    s.links[0].ipv4 = "10.0.0.0/24";
    middle.places = {{{"mu", {}}, {"bus", {}}, true, false}};
    EXPECT_EQ(said_about(s, "middle"), "") << "a link that carries IP too";
}

} // namespace
} // namespace gridspace::launcher

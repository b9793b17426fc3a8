// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/discovery_peers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::Not;
using testing::SizeIs;
using testing::UnorderedElementsAre;

struct Agent final : ProcessSettings {
    std::vector<TopicUse> written, read;
    bool member{true};
    [[nodiscard]] std::vector<TopicUse> writes(Scenario const&, Process const&) const override { return written; }
    [[nodiscard]] std::vector<TopicUse> reads(Scenario const&, Process const&) const override { return read; }
    [[nodiscard]] bool is_member() const override { return member; }
    [[nodiscard]] config::Node settings(Scenario const&, Process const&) const override { return config::Node::map(); }
};

Agent& add(Scenario& s, std::string const& name, std::string_view program) {
    Process process;
    process.name = {name, {}};
    process.host = {"host_" + name, {}};
    process.program = {std::string{program}, {}};
    auto agent = std::make_unique<Agent>();
    Agent& out = *agent;
    process.settings = std::move(agent);
    s.processes.push_back(std::move(process));
    Host host;
    host.name = {"host_" + name, {}};
    host.links = {{"lan", {}}};
    s.hosts.push_back(host);
    return out;
}

/// Agents who ask a controller, and a simulator. Addresses of the hosts end in 1 (simulator), 2 (controller), 3 and on.
Scenario agents(int count) {
    Scenario s;
    s.clock.mode = bus::ClockMode::lockstep;
    Link link;
    link.name = {"lan", {}};
    link.ipv4 = "10.10.0.0/24";
    s.links.push_back(link);
    add(s, "sim", "gridspace-sim").member = false;
    add(s, "mcca", "gridspace-mcca").read = {{.topic = "requests", .type = "ChargingRequest"}};
    for (int i = 1; i <= count; ++i) {
        add(s, "ev" + std::to_string(i), "gridspace-ev").written = {{.topic = "requests", .type = "ChargingRequest"}};
    }
    return s;
}

std::vector<std::string> peers(Scenario const& s, std::string const& process, bool management) {
    std::vector<Port> const ports = plan_ports(s);
    return DiscoveryPeers{s, dataflow(s), ports}.of(process, management, management ? 0 : 1);
}

TEST(DiscoveryPeers, AnAgentLooksForItsControllerAndTheSimulatorAndForNoOtherAgent) {
    Scenario const s = agents(2);
    EXPECT_THAT(peers(s, "ev1", true), UnorderedElementsAre("10.254.0.1:7410", "10.254.0.2:7410"));
    EXPECT_THAT(peers(s, "ev1", false), UnorderedElementsAre("10.10.0.1:7662", "10.10.0.2:7662"));
}

TEST(DiscoveryPeers, WhoKnowsManyIsLookedForAndDoesNotLook) {
    EXPECT_THAT(peers(agents(2), "sim", true), SizeIs(3)) << "few: from both sides";
    Scenario const s = agents(40);
    EXPECT_THAT(peers(s, "sim", true), ElementsAre("10.254.0.2:7410")) << "the controller knows as many as it does";
    EXPECT_THAT(peers(s, "ev1", true), SizeIs(2));
}

TEST(DiscoveryPeers, CountWhoHasToDoWithAProcessAlsoWhereAllAreFoundByMulticast) {
    Scenario s = agents(40);
    std::vector<Port> const ports = plan_ports(s);
    auto const acquaintances = [&](char const* process) {
        return DiscoveryPeers{s, dataflow(s), ports}.acquaintances(process);
    };
    EXPECT_EQ(acquaintances("sim"), 41U) << "the agents and the controller";
    EXPECT_EQ(acquaintances("ev1"), 2U);
    EXPECT_EQ(acquaintances("nobody"), 0U);
    add(s, "own", "exec").written = {{.topic = "x", .type = "ChargingRequest"}};
    EXPECT_GE(acquaintances("sim"), 41U);
}

TEST(DiscoveryPeers, NobodyToLookForIsNotEverybody) {
    Scenario s = agents(0);
    s.processes.erase(s.processes.begin() + 1);
    EXPECT_THAT(peers(s, "sim", true), ElementsAre("10.254.0.1:7410")) << "its own: no peers would mean multicast";
}

TEST(DiscoveryPeers, OnAHostOfSeveralProcessesEachMayBeTheOneThatIsLookedFor) {
    Scenario s = agents(2);
    add(s, "recorder", "gridspace-recorder");
    s.processes.back().host = {"host_sim", {}};
    EXPECT_THAT(peers(s, "ev1", true), IsSupersetOf({"10.254.0.1:7410", "10.254.0.1:7412"}));
    EXPECT_THAT(peers(s, "ev1", false), IsSupersetOf({"10.10.0.1:7662", "10.10.0.1:7664"}));
}

TEST(DiscoveryPeers, AProgramOfSomebodyElseThatExchangesTopicsIsFoundByMulticast) {
    Scenario s = agents(2);
    Agent& own = add(s, "own", "exec");
    EXPECT_THAT(peers(s, "ev1", true), Not(IsEmpty())) << "this one is not on the bus";
    own.written = {{.topic = "x", .type = "ChargingRequest"}};
    EXPECT_THAT(peers(s, "ev1", true), IsEmpty());
}

} // namespace
} // namespace gridspace::launcher

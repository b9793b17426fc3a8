// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/node_config.hpp"

#include "common/text.hpp"

#include <fmt/format.h>

namespace gridspace::bus {
namespace {

using config::Fields;
using config::Node;

void names(Fields& f, std::string_view key, std::vector<std::string>& out, std::string_view doc) {
    std::vector<config::Ref> refs;
    f.references(key, refs, {.doc = doc});
    for (config::Ref& ref : refs) {
        out.push_back(std::move(ref.name));
    }
}

void network(Fields& f, NetworkConfig& network) {
    f.integer("domain", network.domain, {.doc = "DDS domain", .min = 0, .max = 232});
    names(f, "addresses", network.addresses, "IPv4 addresses of the interfaces to use; all when not given");
    names(f, "peers", network.peers, "whom to look for, as ADDRESS:PORT; everybody, by multicast, when not given");
}

void expected(Fields& f, std::string_view key, ExpectedPeers& peers, std::string_view doc) {
    f.map(key, {.doc = doc}, [&](config::Ref const& topic, Fields& t) {
        t.integers("endpoints", peers[topic.name], {.doc = "by process: how many readers or writers it has", .min = 1});
    });
}

Node name_list(std::vector<std::string> const& list) {
    Node node = Node::sequence();
    for (std::string const& name : list) {
        node.items.push_back(Node::scalar(name));
    }
    return node;
}

Node network_node(NetworkConfig const& network) {
    Node node = Node::map();
    node.set("domain", Node::scalar(std::to_string(network.domain)));
    node.set("addresses", name_list(network.addresses));
    if (!network.peers.empty()) {
        Node peers = Node::sequence();
        for (std::string const& peer : network.peers) {
            peers.items.push_back(Node::quoted_text(peer));
        }
        node.set("peers", std::move(peers));
    }
    return node;
}

Node expected_node(ExpectedPeers const& expected) {
    Node node = Node::map();
    for (auto const& [topic, peers] : expected) {
        Node counts = Node::map();
        for (auto const& [process, count] : peers) {
            counts.set(process, Node::scalar(std::to_string(count)));
        }
        node.set(topic, Node::map()).set("endpoints", std::move(counts));
    }
    return node;
}

} // namespace

std::string discovery_address(std::string_view address, std::int64_t domain, int participant) {
    return fmt::format("{}:{}", address, 7400 + 250 * domain + 10 + 2 * participant);
}

void describe(Fields& f, ClockConfig& clock) {
    f.choice<ClockMode>("mode", clock.mode, {{"realtime", ClockMode::realtime}, {"lockstep", ClockMode::lockstep}},
                        {.doc = "lockstep: the simulator waits for its members; realtime: for nobody"});
    f.fraction("quantum_s", clock.quantum_s,
               {.doc = "time quantum of which step and tick are whole multiples", .above = 0});
    f.fraction("tick_s", clock.tick_s, {.doc = "length of a tick", .above = 0});
    f.fraction("ahead_s", clock.ahead_s,
               {.doc = "lockstep: so long beyond a tick its input is complete, and its own ticks end so much later",
                .min = 0});
    f.fraction("promise_s", clock.promise_s,
               {.doc = "lockstep: so long beyond its own tick what it sends is complete", .min = 0});
    f.fraction("ends_at_s", clock.ends_at_s, {.doc = "the end of the run, where ahead_s is not 0", .min = 0});
    std::string epoch = format_utc(clock.epoch_unix_s);
    f.text("epoch", epoch, {.doc = "UTC of simulated time 0"});
    if (auto const seconds = parse_utc(epoch)) {
        clock.epoch_unix_s = *seconds;
    } else {
        f.error("epoch", fmt::format("'{}' is not a UTC time from 1970 to 2199", epoch),
                "for example \"2019-12-01T09:00:00Z\"");
    }
    f.number("member_timeout_s", clock.member_timeout_s,
             {.doc = "how long a wait inside a tick may last before the run is stalled; 0: no limit", .min = 0});
    f.number("start_timeout_s", clock.start_timeout_s,
             {.doc = "how long the start may stand still before everybody is ready; 0: no limit", .min = 0});
    f.integer("max_lag_ticks", clock.max_lag_ticks,
              {.doc = "an idle member still acknowledges this often", .min = 1, .max = 64});
    f.text("simulator", clock.simulator,
           {.doc = "the process that publishes the clock; \"\": nobody, time is UTC (realtime only)"});
    if (clock.simulator.empty()) {
        if (clock.mode == ClockMode::lockstep) {
            f.error("simulator", "in lockstep somebody has to publish the clock",
                    "the name of its process, or mode: realtime");
        }
        if (!f.has("quantum_s")) {
            clock.quantum_s = Rational{1, 1'000'000};
        }
    }
    names(f, "members", clock.members, "all lockstep members");
    names(f, "upstream", clock.upstream, "members whose output this process reads");
    names(f, "downstream", clock.downstream, "members that read this process's output");
    names(f, "late_upstream", clock.late_upstream, "those upstream whose output is due after the tick it is made in");
    names(f, "late_downstream", clock.late_downstream, "those downstream for whom this process's output is so");
}

void describe(Fields& f, NodeConfig& node) {
    f.integer("incarnation", node.incarnation, {.doc = "counts the restarts of this process", .min = 0});
    f.fraction("joins_at_s", node.joins_at_s, {.doc = "simulated time at which a restarted process joins", .min = 0});
    names(f, "absent", node.absent, "expected peers that are gone when this process joins");
    f.file("qos", node.qos, {.doc = "Fast DDS XML profiles of the role"});
    f.object("management", {.doc = "network of clock, acknowledgements, recording and health"},
             [&](Fields& n) { network(n, node.management); });
    f.object("data", {.doc = "network of the studied topics; without it they are on management"},
             [&](Fields& n) { network(n, node.data.emplace()); });
    names(f, "management_topics", node.management_topics, "further topics that stay off the studied network");
    f.object("clock", {.doc = "the simulation clock"}, [&](Fields& c) { describe(c, node.clock); });
    expected(f, "expected_writers", node.expected_writers, "who must be writing the topics that this process reads");
    expected(f, "expected_readers", node.expected_readers, "who must be reading the topics that this process writes");
}

Node to_node(NodeConfig const& config) {
    Node clock = Node::map();
    clock.set("mode", Node::scalar(config.clock.mode == ClockMode::lockstep ? "lockstep" : "realtime"));
    clock.set("quantum_s", Node::scalar(config.clock.quantum_s.to_string()));
    clock.set("tick_s", Node::scalar(config.clock.tick_s.to_string()));
    if (config.clock.ahead_s > Rational{0}) {
        clock.set("ahead_s", Node::scalar(config.clock.ahead_s.to_string()));
    }
    if (config.clock.promise_s > Rational{0}) {
        clock.set("promise_s", Node::scalar(config.clock.promise_s.to_string()));
    }
    if (config.clock.ends_at_s) {
        clock.set("ends_at_s", Node::scalar(config.clock.ends_at_s->to_string()));
    }
    clock.set("epoch", Node::quoted_text(format_utc(config.clock.epoch_unix_s)));
    clock.set("member_timeout_s", Node::scalar(shortest(config.clock.member_timeout_s)));
    clock.set("start_timeout_s", Node::scalar(shortest(config.clock.start_timeout_s)));
    clock.set("max_lag_ticks", Node::scalar(std::to_string(config.clock.max_lag_ticks)));
    clock.set("simulator", Node::quoted_text(config.clock.simulator));
    clock.set("members", name_list(config.clock.members));
    clock.set("upstream", name_list(config.clock.upstream));
    clock.set("downstream", name_list(config.clock.downstream));
    if (!config.clock.late_upstream.empty()) {
        clock.set("late_upstream", name_list(config.clock.late_upstream));
    }
    if (!config.clock.late_downstream.empty()) {
        clock.set("late_downstream", name_list(config.clock.late_downstream));
    }

    Node node = Node::map();
    node.set("incarnation", Node::scalar(std::to_string(config.incarnation)));
    node.set("qos", Node::scalar(config.qos.string()));
    node.set("management", network_node(config.management));
    if (config.data) {
        node.set("data", network_node(*config.data));
    }
    node.set("management_topics", name_list(config.management_topics));
    node.set("clock", std::move(clock));
    node.set("expected_writers", expected_node(config.expected_writers));
    node.set("expected_readers", expected_node(config.expected_readers));
    return node;
}

} // namespace gridspace::bus

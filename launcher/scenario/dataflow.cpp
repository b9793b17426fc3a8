// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/dataflow.hpp"

#include "bus/lockstep/barrier.hpp"
#include "bus/topics.hpp"
#include "common/text.hpp"
#include "launcher/scenario/bumps.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/tick_length.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <set>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Node;

/// What each process sends and receives, asked once: everybody is compared with everybody.
struct Wires {
    explicit Wires(Scenario const& scenario) : bumps{placed_bumps(scenario)} {
        for (Process const& process : scenario.processes) {
            sent.push_back(wires_sent(scenario, process, bumps));
            received.push_back(wires_received(scenario, process, bumps));
        }
    }
    std::vector<PlacedBump> bumps;
    std::vector<std::vector<WireUse>> sent, received; ///< in the order of the processes
};

/// The host whose cable to the switch a process sends into, or receives from.
std::string cable_of(Wires const& wires, Process const& process, WireUse const& use, bool sent) {
    for (PlacedBump const& bump : wires.bumps) {
        for (auto const* way : {&bump.from_host, &bump.to_host}) {
            if (bump.process == process.name.name && way->has_value() &&
                (sent ? (*way)->out : (*way)->in) == use.link) {
                return bump.host;
            }
        }
    }
    return process.host.name;
}

/// What comes from a cable does not go back into it: who sits in it, and takes what the switch gives, hears nothing of
/// what goes into the switch there.
bool is_not_heard(Scenario const& scenario, Wires const& wires, Process const& sender, WireUse const& sent,
                  Process const& receiver, WireUse const& received) {
    if (sender.host == receiver.host || received.at_switch) {
        return false;
    }
    bool const through_switch =
        std::ranges::any_of(scenario.links, [&](Link const& link) { return link.name.name == received.link; });
    return through_switch && cable_of(wires, sender, sent, true) == cable_of(wires, receiver, received, false);
}

/// Members that send frames where a process listens.
void add_senders(Scenario const& scenario, Wires const& wires, std::size_t receiver, std::set<std::string>& out) {
    Process const& process = scenario.processes[receiver];
    for (WireUse const& received : wires.received[receiver]) {
        for (std::size_t i = 0; i < scenario.processes.size(); ++i) {
            Process const& sender = scenario.processes[i];
            bool const heard = std::ranges::any_of(wires.sent[i], [&](WireUse const& use) {
                return use.link == received.link && use.ethertype == received.ethertype &&
                       !is_not_heard(scenario, wires, sender, use, process, received);
            });
            if (heard && i != receiver && sender.settings->is_member()) {
                out.insert(sender.name.name);
            }
        }
    }
}

/// Members that write a topic which `member` reads; the simulator apart.
void add_writers(Dataflow const& flow, Scenario const& scenario, std::string const& member, bool triggering_only,
                 std::set<std::string>& out) {
    for (auto const& [topic, readers] : flow.readers) {
        for (Dataflow::Endpoint const& reader : readers) {
            if (reader.process != member || (triggering_only && !reader.use.triggers)) {
                continue;
            }
            auto const writers = flow.writers.find(topic);
            if (writers == flow.writers.end()) {
                continue;
            }
            for (Dataflow::Endpoint const& writer : writers->second) {
                if (writer.process != member && scenario.find_process(writer.process)->settings->is_member()) {
                    out.insert(writer.process);
                }
            }
        }
    }
}

Node name_list(std::vector<std::string> const& names) {
    Node node = Node::sequence();
    for (std::string const& name : names) {
        node.items.push_back(Node::scalar(name));
    }
    return node;
}

/// A circle among the members, as "a -> b -> a"; empty when there is none.
std::string find_circle(std::vector<bus::MemberPlan> const& members) {
    std::map<std::string, bus::MemberPlan const*> by_name;
    for (bus::MemberPlan const& member : members) {
        by_name[member.name] = &member;
    }
    std::set<std::string> done;
    std::vector<std::string> path;
    std::string circle;
    std::function<void(std::string const&)> const walk = [&](std::string const& name) {
        if (!circle.empty() || done.contains(name)) {
            return;
        }
        auto const seen = std::find(path.begin(), path.end(), name);
        if (seen != path.end()) {
            std::vector<std::string> loop{seen, path.end()};
            std::reverse(loop.begin(), loop.end()); // upstream was walked; data flows the other way
            loop.push_back(loop.front());
            circle = join(loop, " -> ");
            return;
        }
        path.push_back(name);
        auto const& late = by_name.at(name)->late;
        for (std::string const& up : by_name.at(name)->upstream) {
            if (std::find(late.begin(), late.end(), up) == late.end()) {
                walk(up);
            }
        }
        path.pop_back();
        done.insert(name);
    };
    for (bus::MemberPlan const& member : members) {
        walk(member.name);
    }
    return circle;
}

/// In real time nobody waits for what somebody else starts, and it may come and go.
bool joins_when_it_likes(Scenario const& scenario, Process const& process) {
    return is_external(process) && scenario.clock.mode == bus::ClockMode::realtime;
}

std::vector<std::string> other_members(Scenario const& scenario, Process const& process) {
    std::vector<std::string> out;
    for (Process const& other : scenario.processes) {
        if (&other != &process && other.settings->is_member() && !joins_when_it_likes(scenario, other)) {
            out.push_back(other.name.name);
        }
    }
    std::sort(out.begin(), out.end());
    return out;
}

/// A frame goes to the switch and does not come back to the host that sent it: who waits for it there waits for ever.
void check_hosts_of_frames(Scenario const& scenario, Diagnostics& diagnostics) {
    Wires const wires{scenario};
    for (std::size_t r = 0; r < scenario.processes.size(); ++r) {
        Process const& receiver = scenario.processes[r];
        for (WireUse const& received : wires.received[r]) {
            for (std::size_t i = 0; i < scenario.processes.size(); ++i) {
                Process const& sender = scenario.processes[i];
                if (i == r || sender.host != receiver.host || received.at_switch) {
                    continue;
                }
                bool const heard = std::ranges::any_of(wires.sent[i], [&](WireUse const& use) {
                    return use.link == received.link && use.ethertype == received.ethertype;
                });
                if (heard) {
                    diagnostics.error(receiver.name.where,
                                      fmt::format("process '{}' waits for frames of '{}' on '{}', and both are on the "
                                                  "host '{}'",
                                                  receiver.name.name, sender.name.name, received.link,
                                                  receiver.host.name),
                                      "a host of its own for one of them: no frame comes back to who sent it",
                                      static_cast<int>(receiver.name.name.size()));
                    return;
                }
            }
        }
    }
}

/// A port keeps 4 * kMostFrames (recorder/app/frame_capture.cpp). Who collects is asked in the tick after kMostFrames
/// are there: with those of two ticks, and GOOSE.
bool may_collect_frames(Scenario const& scenario) {
    Rational all{0};
    for (Process const& process : scenario.processes) {
        all = all + frames_per_second(scenario, process);
    }
    return all * scenario.tick_s() <= Rational{lockstep::Barrier::kMostFrames};
}

} // namespace

Dataflow dataflow(Scenario const& scenario) {
    Dataflow flow;
    for (Process const& process : scenario.processes) {
        bool const expected = process.settings->is_expected() && !joins_when_it_likes(scenario, process);
        for (TopicUse const& use : process.settings->writes(scenario, process)) {
            flow.writers[use.topic].push_back({process.name.name, use, expected});
        }
        for (TopicUse const& use : process.settings->reads(scenario, process)) {
            flow.readers[use.topic].push_back({process.name.name, use, expected});
        }
    }
    Process const* simulator = scenario.simulator();
    std::set<std::string> feeding; // write what the simulator reads
    for (TopicUse const& use :
         simulator == nullptr ? std::vector<TopicUse>{} : simulator->settings->reads(scenario, *simulator)) {
        if (auto const writers = flow.writers.find(use.topic); writers != flow.writers.end()) {
            for (Dataflow::Endpoint const& writer : writers->second) {
                feeding.insert(writer.process);
            }
        }
    }
    Wires const wires{scenario};
    for (std::size_t i = 0; i < scenario.processes.size(); ++i) {
        Process const& process = scenario.processes[i];
        if (!process.settings->is_member() || joins_when_it_likes(scenario, process)) {
            continue;
        }
        bus::MemberPlan plan;
        plan.name = process.name.name;
        std::set<std::string> triggering;
        add_senders(scenario, wires, i, triggering);
        std::set<std::string> upstream = triggering;
        add_writers(flow, scenario, plan.name, true, triggering);
        add_writers(flow, scenario, plan.name, false, upstream);
        plan.triggered_by.assign(triggering.begin(), triggering.end());
        plan.upstream.assign(upstream.begin(), upstream.end());
        if (process.program.name ==
            "gridspace-recorder") { // it keeps the acknowledgements of those too who only listen
            plan.upstream = other_members(scenario, process);
            if (may_collect_frames(scenario)) { // it works in batches
                plan.collects_frames = !plan.triggered_by.empty();
                plan.triggered_by.clear();
            }
        } else {
            for (std::string const& up : plan.upstream) {
                if (scenario.find_process(up)->settings->sends_late(scenario)) {
                    plan.late.push_back(up);
                    std::erase(plan.triggered_by, up);
                }
            }
        }
        plan.feeds_simulator = feeding.contains(plan.name);
        flow.members.push_back(std::move(plan));
    }
    std::sort(flow.members.begin(), flow.members.end(), [](auto const& a, auto const& b) { return a.name < b.name; });
    return flow;
}

bus::ExpectedPeers Dataflow::expected_writers(std::string const& process) const {
    bus::ExpectedPeers out;
    for (auto const& [topic, all_readers] : readers) {
        bool const reads =
            std::any_of(all_readers.begin(), all_readers.end(), [&](auto const& r) { return r.process == process; });
        auto const topic_writers = writers.find(topic);
        if (!reads || topic_writers == writers.end()) {
            continue;
        }
        for (Endpoint const& writer : topic_writers->second) {
            if (writer.process != process && writer.expected) {
                out[topic][writer.process] += writer.use.endpoints;
            }
        }
    }
    return out;
}

bus::ExpectedPeers Dataflow::expected_readers(std::string const& process) const {
    bus::ExpectedPeers out;
    for (auto const& [topic, all_writers] : writers) {
        bool const writes =
            std::any_of(all_writers.begin(), all_writers.end(), [&](auto const& w) { return w.process == process; });
        auto const topic_readers = readers.find(topic);
        if (!writes || topic_readers == readers.end()) {
            continue;
        }
        for (Endpoint const& reader : topic_readers->second) {
            if (reader.process != process && reader.expected) {
                out[topic][reader.process] += reader.use.endpoints;
            }
        }
    }
    return out;
}

void check_dataflow(Scenario const& scenario, Diagnostics& diagnostics) {
    Dataflow const flow = dataflow(scenario);
    auto const mark_of = [&](std::string const& process) { return scenario.find_process(process)->name; };
    for (auto const& [topic, readers] : flow.readers) {
        auto const writers = flow.writers.find(topic);
        for (Dataflow::Endpoint const& reader : readers) {
            Ref const name = mark_of(reader.process);
            if (writers == flow.writers.end() && reader.use.optional) {
                continue;
            }
            if (writers == flow.writers.end()) {
                std::vector<std::string> written;
                for (auto const& [other, ignored] : flow.writers) {
                    written.push_back(other);
                }
                diagnostics.error(
                    name.where,
                    fmt::format("process '{}' reads the topic '{}', which nobody writes", reader.process, topic),
                    bus::is_management_topic(topic)
                        ? "topics of the framework need not be listed: a process may read them as it likes"
                        : did_you_mean(topic, written, "is a process missing, or a topic misspelt?"),
                    static_cast<int>(name.name.size()));
                continue;
            }
            for (Dataflow::Endpoint const& writer : writers->second) {
                if (writer.use.type != reader.use.type) {
                    diagnostics.error(name.where,
                                      fmt::format("process '{}' reads '{}' as {}, and '{}' writes it as {}",
                                                  reader.process, topic, reader.use.type, writer.process,
                                                  writer.use.type),
                                      "all who use a topic must agree on its type", static_cast<int>(name.name.size()));
                }
            }
        }
    }
    for (auto const& [topic, writers] : flow.writers) {
        bool const commands = writers.front().use.type == "TripCommand"; // others may be there for the recording alone
        if (commands && !flow.readers.contains(topic)) {
            Ref const name = mark_of(writers.front().process);
            diagnostics.error(
                name.where,
                fmt::format("process '{}' commands the topic '{}', which nobody reads", writers.front().process, topic),
                "is it among the `subscribe` topics of simulation.gateways?", static_cast<int>(name.name.size()));
        }
    }
    if (scenario.clock.mode != bus::ClockMode::lockstep) {
        return;
    }
    if (std::string const circle = find_circle(flow.members); !circle.empty()) {
        diagnostics.error(scenario.processes.front().name.where,
                          fmt::format("the members wait for each other in a circle: {}", circle),
                          "in lockstep a chain of processes must come to an end within a tick");
    }
    check_hosts_of_frames(scenario, diagnostics);
    check_loops(scenario, flow, diagnostics);
}

std::vector<TopicUse> recorded_topics(Scenario const& scenario, Process const& recorder) {
    std::map<std::string, TopicUse> topics;
    for (Process const& process : scenario.processes) {
        if (&process == &recorder) {
            continue;
        }
        for (TopicUse const& use : process.settings->writes(scenario, process)) {
            if (!bus::is_diagnostic_topic(use.topic)) {
                topics.emplace(use.topic, TopicUse{use.topic, use.type, 1, false});
            }
        }
    }
    std::vector<TopicUse> out;
    for (auto& [name, use] : topics) {
        out.push_back(std::move(use));
    }
    return out;
}

config::Node simulator_settings(Scenario const& scenario) {
    Node node = Node::map();
    Node simulation = *scenario.resolved.find("simulation");
    simulation.set("network", Node::scalar(std::filesystem::absolute(scenario.simulation.network).string()));
    node.set("simulation", std::move(simulation));
    node.set("speed", Node::scalar(shortest(scenario.clock.speed)));
    if (scenario.clock.start_at_utc_second) {
        node.set("start_on_utc_second", Node::scalar("true"));
    }
    Node events = Node::map(), holds = Node::sequence();
    if (Node const* all = scenario.resolved.find("events")) {
        events = *all;
    }
    node.set("events", std::move(events));
    Node members = Node::map();
    for (bus::MemberPlan const& plan : dataflow(scenario).members) {
        Node member = Node::map();
        member.set("upstream", name_list(plan.upstream));
        member.set("triggered_by", name_list(plan.triggered_by));
        member.set("late", name_list(plan.late));
        member.set("feeds_simulator", Node::scalar(plan.feeds_simulator ? "true" : "false"));
        member.set("collects_frames", Node::scalar(plan.collects_frames ? "true" : "false"));
        members.set(plan.name, std::move(member));
    }
    node.set("members", std::move(members));
    for (sim::Event const& event : process_events(scenario)) {
        holds.items.push_back(Node::scalar(event.at_s->to_string()));
    }
    node.set("holds_s", std::move(holds));
    Node signals = Node::sequence();
    for (std::string const& pattern : scenario.record.signals) {
        signals.items.push_back(Node::quoted_text(pattern));
    }
    node.set("signals", std::move(signals));
    return node;
}

} // namespace gridspace::launcher

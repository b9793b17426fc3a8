// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/monitor_settings.hpp"

#include "agents/relay/functions/function_set.hpp"
#include "common/text.hpp"
#include "launcher/judge/expectation_rule.hpp"
#include "launcher/judge/protection_chain.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/wire_use.hpp"
#include "sim/network/network.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace gridspace::launcher {
namespace {

using config::Node;

Node entry(std::initializer_list<std::pair<std::string_view, std::string>> texts) {
    Node node = Node::map();
    for (auto const& [key, text] : texts) {
        if (!text.empty()) {
            node.set(key, Node::quoted_text(text));
        }
    }
    return node;
}

std::string label_of(sim::Element const& element) {
    return element.label.empty() ? element.name.name : element.label;
}

void add_network(Node& run, sim::Network const& network) {
    Node buses = Node::sequence(), branches = Node::sequence(), breakers = Node::sequence(), cts = Node::sequence(),
         devices = Node::sequence();
    for (sim::Bus const& bus : network.buses) {
        Node node = entry({{"name", bus.name.name}, {"label", label_of(bus)}});
        node.set("voltage_v", Node::scalar(shortest(bus.voltage_v)));
        if (bus.diagram_x && bus.diagram_y) {
            node.set("x", Node::scalar(shortest(*bus.diagram_x)));
            node.set("y", Node::scalar(shortest(*bus.diagram_y)));
        }
        buses.items.push_back(std::move(node));
    }
    for (sim::TwoPort const* e : two_ports(network)) {
        branches.items.push_back(entry({{"name", e->name.name},
                                        {"label", label_of(*e)},
                                        {"from", e->from.name},
                                        {"to", e->to.name},
                                        {"kind", std::string{e->kind().prefix}}}));
    }
    auto const end_of = [](sim::LineEnd end) { return end == sim::LineEnd::from ? "from" : "to"; };
    for (sim::LineSwitch const* e : sim::all<sim::LineSwitch>(network)) {
        breakers.items.push_back(entry({{"name", e->name.name}, {"line", e->line.name}, {"end", end_of(e->end)}}));
    }
    for (sim::Instrument const* e : sim::all<sim::Instrument>(network)) {
        if (auto const place = e->place(); !place.line.empty()) {
            cts.items.push_back(entry({{"name", e->name.name}, {"line", place.line.name}, {"end", end_of(place.end)}}));
        }
    }
    for (sim::OnePort const* e : one_ports(network)) {
        devices.items.push_back(entry({{"name", e->name.name},
                                       {"label", label_of(*e)},
                                       {"bus", e->bus.name},
                                       {"kind", std::string{e->kind().prefix}}}));
    }
    run.set("frequency_hz", Node::scalar(shortest(network.frequency_hz)));
    run.set("buses", std::move(buses));
    run.set("branches", std::move(branches));
    run.set("breakers", std::move(breakers));
    run.set("cts", std::move(cts));
    run.set("devices", std::move(devices));
}

} // namespace

namespace {

Node faults_of(std::vector<sim::Event> const& events) {
    Node faults = Node::sequence();
    for (sim::Event const& event : events) {
        if (!event.fault || !event.at_s) {
            continue;
        }
        Node node = entry({{"name", event.name.name}, {"line", event.fault->line}, {"bus", event.fault->bus}});
        node.set("position_percent", Node::scalar(shortest(event.fault->position_percent)));
        node.set("at_s", Node::scalar(shortest(event.at_s->to_double())));
        if (event.clear_after_ms) {
            node.set("until_s",
                     Node::scalar(shortest(event.at_s->to_double() + event.clear_after_ms->to_double() / 1000)));
        }
        faults.items.push_back(std::move(node));
    }
    return faults;
}

/// What a relay does: the differential of a line, or each class of its functions once.
Node functions_of(Node const& process) {
    Node out = Node::sequence();
    Node const* const functions = process.find("functions");
    if (functions == nullptr) {
        out.items.push_back(Node::quoted_text("87L"));
        return out;
    }
    std::set<std::string_view> known;
    for (Node::Entry const& entry : functions->entries) {
        if (relay::NodeClass of{}; relay::class_in(entry.key, of) && known.insert(relay::device_number(of)).second) {
            out.items.push_back(Node::quoted_text(std::string{relay::device_number(of)}));
        }
    }
    return out;
}

Node relays_of(Node const& scenario) {
    Node relays = Node::sequence();
    for (ProtectionChain const& chain : protection_chains(scenario)) {
        Node node = entry({{"name", chain.relay}}), cts = Node::sequence(), breakers = Node::sequence();
        for (ProtectionChain::End const& end : chain.ends) {
            if (!end.transformer.empty()) {
                cts.items.push_back(Node::quoted_text(end.transformer));
            }
        }
        for (std::string const& breaker : chain.breakers()) {
            breakers.items.push_back(Node::quoted_text(breaker));
        }
        node.set("functions", functions_of(*scenario.find("processes")->find(chain.relay)));
        node.set("cts", std::move(cts));
        node.set("breakers", std::move(breakers));
        relays.items.push_back(std::move(node));
    }
    return relays;
}

Node expectations_of(Node const& expect) {
    config::Diagnostics reported; // when the scenario was checked
    Node out = Node::sequence();
    for (Expectation const& e : read_expectations(expect, reported)) {
        Node node =
            entry({{"name", e.name.name}, {"rule", rule_of(e)}, {"accepted", e.band().to_string()}, {"unit", e.unit}});
        node.set("advisory", Node::scalar(e.advisory ? "true" : "false"));
        out.items.push_back(std::move(node));
    }
    return out;
}

} // namespace

Node monitored_run(Scenario const& scenario, std::string const& folder) {
    Node run = entry({{"mode", scenario.clock.mode == bus::ClockMode::lockstep ? "lockstep" : "realtime"},
                      {"speed", scenario.clock.speed > 0 ? shortest(scenario.clock.speed) : "max"},
                      {"events", folder + "/events.ndjson"},
                      {"graph", folder + "/graph.json"}});
    run.set("duration_s", Node::scalar(shortest(scenario.simulation.duration().to_double())));
    Node processes = Node::sequence(), wires = Node::sequence();
    for (Process const& process : scenario.processes) {
        auto const kind = parse_run_on(process.run_on).value_or(RunOn{}).kind;
        bool const here =
            kind == RunOn::Kind::native || kind == RunOn::Kind::qemu_user; // others have a board of their own
        processes.items.push_back(
            entry({{"name", process.name.name},
                   {"program", process.program.name},
                   {"host", process.host.name},
                   {"pid_file", here ? folder + "/processes/" + process.name.name + ".pid" : ""}}));
        auto const add = [&](std::vector<WireUse> const& uses, bool sends) {
            for (WireUse const& use : uses) {
                if (use.stream.empty()) { // a capture: it takes whatever passes, and is no end of any stream
                    continue;
                }
                Node node = entry({{"process", process.name.name},
                                   {"stream", use.stream},
                                   {"kind", use.ethertype == iec61850::kGooseEthertype ? "goose" : "smv"},
                                   {"link", use.link}});
                node.set("sends", Node::scalar(sends ? "true" : "false"));
                wires.items.push_back(std::move(node));
            }
        };
        add(frames_sent(scenario, process), true);
        add(frames_received(scenario, process), false);
    }
    run.set("processes", std::move(processes));
    run.set("wires", std::move(wires));
    if (scenario.network) {
        add_network(run, *scenario.network);
    }
    run.set("relays", relays_of(scenario.resolved));
    run.set("faults", faults_of(scenario.events));
    run.set("expectations", expectations_of(scenario.expect));
    return run;
}

Node recorded_monitor(Scenario const& scenario) {
    Node management = Node::map(), bus = Node::map(), settings = Node::map();
    management.set("domain", Node::scalar("0")); // it is not joined
    bus.set("management", std::move(management));
    settings.set("scenario", Node::quoted_text(scenario.name));
    settings.set("recording", Node::quoted_text("data.mcap"));
    settings.set("run", monitored_run(scenario, "."));
    Node out = entry({{"process", "monitor"}, {"program", "gridspace-monitor"}});
    out.set("bus", std::move(bus));
    out.set("settings", std::move(settings));
    return out;
}

} // namespace gridspace::launcher

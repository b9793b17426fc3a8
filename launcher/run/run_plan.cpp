// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/run_plan.hpp"

#include "common/privileges/capabilities.hpp"
#include "common/realtime.hpp"
#include "common/text.hpp"
#include "launcher/run/emulation.hpp"
#include "launcher/scenario/bumps.hpp"
#include "launcher/scenario/dataflow.hpp"
#include "launcher/scenario/discovery_peers.hpp"
#include "launcher/scenario/guest.hpp"
#include "launcher/scenario/installation.hpp"
#include "launcher/scenario/run_on.hpp"
#include "launcher/scenario/tick_length.hpp"
#include "launcher/scenario/wire_use.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace gridspace::launcher {
namespace {

using config::Node;

/// Addresses of a host on the links that carry IP, and on the management network.
std::vector<std::string> addresses_of(std::vector<Port> const& ports, std::string const& host, bool management) {
    std::vector<std::string> out;
    for (Port const& port : ports) {
        if (port.host == host && !port.address.empty() && (port.link == kManagementLink) == management) {
            out.push_back(port.address);
        }
    }
    return out;
}

bus::NodeConfig node_config(Scenario const& scenario, Process const& process, Dataflow const& flow,
                            WorkAhead const& ahead, DiscoveryPeers const& peers, RunPlan const& plan,
                            PlanOptions const& options) {
    bus::NodeConfig node;
    node.process = process.name.name;
    node.program = process.program.name;
    node.qos = qos_file(process.qos.name);
    if (options.namespaces) {
        node.management = {0, addresses_of(plan.ports, process.host.name, true), peers.of(node.process, true, 0)};
        if (auto addresses = addresses_of(plan.ports, process.host.name, false); !addresses.empty()) {
            node.data = bus::NetworkConfig{1, std::move(addresses), peers.of(node.process, false, 1)};
        }
    } else {
        node.management = {options.domain, {"127.0.0.1"}, {}};
        node.data = bus::NetworkConfig{options.domain + 1, {"127.0.0.1"}, {}};
    }
    bus::ClockConfig& clock = node.clock;
    clock.mode = scenario.clock.mode;
    clock.quantum_s = scenario.quantum_s();
    clock.tick_s = scenario.tick_s();
    if (auto const found = ahead.ahead_s.find(node.process); found != ahead.ahead_s.end()) {
        clock.ahead_s = found->second;
        clock.ends_at_s = scenario.simulation.duration();
    }
    if (auto const found = ahead.promise_s.find(node.process); found != ahead.promise_s.end()) {
        clock.promise_s = found->second;
    }
    clock.epoch_unix_s = parse_utc(scenario.simulation.epoch).value_or(0);
    clock.member_timeout_s = scenario.clock.member_timeout_s * patience(scenario);
    // The simulator starts last, hears from everybody how far they are, and names who is missing. The others wait as
    // long as there is a simulator: what it waits for may have nothing to do with them.
    if (&process == scenario.simulator() || is_external(process)) {
        clock.start_timeout_s = scenario.clock.start_timeout_s * patience(scenario);
    } else {
        clock.start_timeout_s = 0;
    }
    clock.simulator = scenario.simulator()->name.name;
    for (bus::MemberPlan const& member : flow.members) {
        clock.members.push_back(member.name);
        if (member.name == node.process) {
            clock.upstream = member.upstream;
            clock.late_upstream = member.late;
        }
        if (std::find(member.upstream.begin(), member.upstream.end(), node.process) != member.upstream.end()) {
            clock.downstream.push_back(member.name);
        }
        if (std::find(member.late.begin(), member.late.end(), node.process) != member.late.end()) {
            clock.late_downstream.push_back(member.name);
        }
    }
    for (auto const& [topic, writers] : flow.writers) { // what is said about the studied network does not travel on it
        if (writers.front().use.type == "IdsVerdict" || writers.front().use.type == "AttackLabel") {
            node.management_topics.push_back(topic);
        }
    }
    node.expected_writers = flow.expected_writers(node.process);
    node.expected_readers = flow.expected_readers(node.process);
    return node;
}

/// "topic:process:count ..."
std::string expected_text(bus::ExpectedPeers const& expected) {
    std::vector<std::string> words;
    for (auto const& [topic, peers] : expected) {
        for (auto const& [process, count] : peers) {
            words.push_back(fmt::format("{}:{}:{}", topic, process, count));
        }
    }
    return join(words, " ");
}

/// What a program that is not ours needs to take part, in a form that every language reads without a YAML library.
std::map<std::string, std::string> environment_of(bus::NodeConfig const& node) {
    bus::ClockConfig const& clock = node.clock;
    bus::NetworkConfig const& data = node.data ? *node.data : node.management;
    auto const first = [](std::vector<std::string> const& addresses) {
        return addresses.empty() ? std::string{} : addresses.front();
    };
    return {{"GRIDSPACE_PROCESS", node.process},
            {"GRIDSPACE_INCARNATION", std::to_string(node.incarnation)},
            {"GRIDSPACE_JOINS_AT_S", "0"}, // these two change with a restart
            {"GRIDSPACE_ABSENT", ""},
            {"GRIDSPACE_MANAGEMENT_DOMAIN", std::to_string(node.management.domain)},
            {"GRIDSPACE_MANAGEMENT_ADDRESS", first(node.management.addresses)},
            {"GRIDSPACE_DATA_DOMAIN", std::to_string(data.domain)},
            {"GRIDSPACE_DATA_ADDRESS", first(data.addresses)},
            {"GRIDSPACE_CLOCK_MODE", clock.mode == bus::ClockMode::lockstep ? "lockstep" : "realtime"},
            {"GRIDSPACE_SIMULATOR", clock.simulator},
            {"GRIDSPACE_EPOCH_UNIX_S", std::to_string(clock.epoch_unix_s)},
            {"GRIDSPACE_QUANTUM_S", clock.quantum_s.to_string()},
            {"GRIDSPACE_TICK_S", clock.tick_s.to_string()},
            {"GRIDSPACE_MEMBERS", join(clock.members, " ")},
            {"GRIDSPACE_UPSTREAM", join(clock.upstream, " ")},
            {"GRIDSPACE_DOWNSTREAM", join(clock.downstream, " ")},
            {"GRIDSPACE_EXPECTED_WRITERS", expected_text(node.expected_writers)},
            {"GRIDSPACE_EXPECTED_READERS", expected_text(node.expected_readers)}};
}

/// In real time: who is waited for by others is above them, so the simulator is first. What only watches stays below
/// everybody.
int fifo_priority(Scenario const& scenario, std::string_view program) {
    if (scenario.clock.mode == bus::ClockMode::lockstep || !scenario.clock.fifo) {
        return 0;
    }
    static constexpr std::pair<std::string_view, int> kPriorities[]{
        {"gridspace-link", 49},    {"gridspace-sim", 49},     {"gridspace-mu", 47},      {"gridspace-relay", 46},
        {"gridspace-breaker", 46}, {"gridspace-gateway", 46}, {"gridspace-attacker", 45}};
    for (auto const& [name, priority] : kPriorities) {
        if (name == program) {
            return priority;
        }
    }
    return 0;
}

/// Raw frames are for who sends, receives or sits between them, and for a user's program that has a link to do so on.
std::optional<std::uint64_t> capabilities(Scenario const& scenario, Process const& process,
                                          PlannedProcess const& plan) {
    if (plan.run_on.kind != RunOn::Kind::native && plan.run_on.kind != RunOn::Kind::qemu_user) {
        return std::nullopt;
    }
    std::vector<WireUse> const received = frames_received(scenario, process);
    bool const raw_frames = !frames_sent(scenario, process).empty() || !received.empty() ||
                            !process.settings->bumps(scenario, process).empty() || !process.interface.empty();
    bool const elsewhere = !plan.networks.empty() || std::any_of(received.begin(), received.end(),
                                                                 [](WireUse const& use) { return use.at_switch; });
    auto const host = std::find_if(scenario.hosts.begin(), scenario.hosts.end(),
                                   [&](Host const& h) { return h.name.name == plan.host; });
    bool const users = plan.is_foreign && host != scenario.hosts.end() && !host->links.empty();
    std::uint64_t out = raw_frames || users || elsewhere ? kMayOpenRawSockets : 0;
    if (elsewhere) { // the networks of switches and of other hosts are found in /proc, as the supervisor's
        out |= kMayEnterNamespaces | kMayTrace;
    }
    if (!process.settings->carried_by().empty()) { // process numbers of their own; the program in it does without
        out |= kMayEnterNamespaces | kMayLimitOthers;
    }
    return out;
}

/// What is executed here, be it an emulator or ssh. `planned`: where and as what the process runs.
std::vector<std::string> command_of(Process const& process, PlannedProcess const& planned, RunPlan const& plan,
                                    PlanOptions const& options) {
    std::vector<std::string> command =
        guest::command(process.settings->command(), planned.is_guest ? plan.ports : std::vector<Port>{}, planned.host);
    if (command.empty()) {
        bool const native = planned.run_on.kind == RunOn::Kind::native;
        command = {native ? program_file(planned.program).string() : planned.program};
    }
    if (process.settings->is_daemon()) {
        for (std::string const& word :
             {std::string{"--config"}, planned.config_file.string(), std::string{"--log-level"}, options.log_level}) {
            command.push_back(word);
        }
    }
    if (planned.run_on.kind == RunOn::Kind::qemu_user) {
        return qemu_user_command(std::move(command));
    }
    if (planned.run_on.kind == RunOn::Kind::qemu_system) {
        return qemu_system_command(command, planned.config_file, plan.ports, planned.host);
    }
    if (planned.run_on.kind == RunOn::Kind::ssh) {
        auto const bundle = options.boards.find(planned.name);
        return ssh_board_command(command, planned.config_file, process,
                                 bundle == options.boards.end() ? "BUNDLE" : bundle->second, plan.ports,
                                 plan.member_timeout_s);
    }
    return command;
}

PlannedProcess plan_process(Scenario const& scenario, Process const& process, bus::NodeConfig const& node,
                            RunPlan const& plan, PlanOptions const& options) {
    PlannedProcess out;
    out.name = process.name.name;
    std::string_view const carrier = process.settings->carried_by();
    out.program = carrier.empty() ? process.program.name : carrier;
    out.host = process.host.name;
    out.cpu = process.cpu;
    out.run_on = parse_run_on(process.run_on).value_or(RunOn{});
    out.fifo_priority = fifo_priority(scenario, out.program);
    out.is_simulator = &process == scenario.simulator();
    out.is_foreign = process.is_foreign();
    out.has_status = process.settings->is_daemon();
    out.is_member = process.settings->is_member();
    out.is_observer = !out.is_member && !out.is_simulator;
    out.is_guest = process.settings->is_guest();
    if (Readiness const* const ready = process.settings->readiness()) {
        out.ready_says = ready->says.name;
        out.ready_within_s = ready->within_s;
    }
    out.listen = process.settings->listen();
    out.interface = process.interface;
    out.networks = process.settings->networks(scenario, process);
    out.capabilities = capabilities(scenario, process, out);
    out.config_file = plan.folder / "processes" / (out.name + ".yaml");
    out.log_file = plan.folder / "logs" / (out.name + ".log");

    out.config = Node::map();
    out.config.set("process", Node::scalar(out.name));
    out.config.set("program", Node::scalar(out.program));
    out.config.set("bus", to_node(node));
    out.config.set("settings", process.settings->settings(scenario, process));

    if (options.allow_control && out.program == "gridspace-monitor") {
        out.config.find("settings")->set("control_token", Node::quoted_text("../control.token"));
    }

    out.command = command_of(process, out, plan, options);
    out.environment = environment_of(node);
    out.environment["GRIDSPACE_CONFIG"] = out.config_file.string();
    out.environment["GRIDSPACE_RUN_FOLDER"] = plan.folder.string();
    return out;
}

/// Members and simulator share memory where all of them are our programs or made with our library, on this machine and
/// for its processor.
std::size_t board_places(Scenario const& scenario, Dataflow const& flow) {
    bool const all_can = std::ranges::all_of(scenario.processes, [&](Process const& process) {
        bool const takes_part = process.settings->is_member() || &process == scenario.simulator();
        return !takes_part || (process.settings->is_daemon() && !is_external(process) &&
                               parse_run_on(process.run_on).value_or(RunOn{}).kind == RunOn::Kind::native);
    });
    bool const wanted = scenario.clock.mode == bus::ClockMode::lockstep && scenario.clock.shared_memory;
    return wanted && all_can ? flow.members.size() + 1 : 0;
}

} // namespace

RunPlan make_plan(Scenario const& scenario, PlanOptions const& options) {
    RunPlan plan;
    plan.scenario = scenario.name;
    plan.folder = options.folder;
    plan.namespaces = options.namespaces;
    plan.processors = options.processors;
    plan.links = scenario.links;
    plan.ports = plan_ports(scenario);
    for (Process const& process : scenario.processes) {
        if (process.settings->sends_late(scenario)) {
            plan.boxed_ip_links.insert(raw_link(scenario, process));
        }
    }
    plan.bumps = placed_bumps(scenario);
    plan.duration_s = scenario.simulation.duration().to_double();
    plan.lockstep = scenario.clock.mode == bus::ClockMode::lockstep;
    plan.allow_control = options.allow_control;
    plan.start_timeout_s = scenario.clock.start_timeout_s * patience(scenario);
    plan.member_timeout_s = scenario.clock.member_timeout_s * patience(scenario);
    for (Host const& host : scenario.hosts) {
        plan.hosts.push_back(host.name.name);
    }
    Dataflow const flow = dataflow(scenario);
    WorkAhead const ahead = work_ahead(scenario, flow);
    DiscoveryPeers const peers{scenario, flow, plan.ports};
    for (Process const& process : scenario.processes) {
        bus::NodeConfig const node = node_config(scenario, process, flow, ahead, peers, plan, options);
        plan.processes.push_back(plan_process(scenario, process, node, plan, options));
        plan.processes.back().acquaintances = peers.acquaintances(process.name.name);
    }
    plan.board_places = board_places(scenario, flow);
    std::stable_partition(plan.processes.begin(), plan.processes.end(),
                          [](PlannedProcess const& p) { return !p.is_simulator; });
    for (sim::Event const& event : process_events(scenario)) {
        std::vector<ProcessAction> process_actions;
        using Kind = ProcessAction::Kind;
        for (auto const& [kind, target] : {std::pair{Kind::kill, &event.kill},
                                           {Kind::pause, &event.pause},
                                           {Kind::resume, &event.resume},
                                           {Kind::restart, &event.restart}}) {
            if (!target->empty()) {
                process_actions.push_back({kind, event.name.name, target->name, event.at_s->to_double()});
            }
        }
        plan.holds.push_back(std::move(process_actions));
    }
    return plan;
}

void settle_scheduling(RunPlan& plan) {
    int highest = 0;
    for (PlannedProcess const& process : plan.processes) {
        highest = std::max(highest, process.fifo_priority);
    }
    if (plan.lockstep) {
        return;
    }
    if (highest == 0) {
        plan.scheduling = "SCHED_OTHER, as the scenario asks";
        return;
    }
    if (may_schedule_fifo(highest)) {
        plan.scheduling = "SCHED_FIFO";
        return;
    }
    for (PlannedProcess& process : plan.processes) {
        process.fifo_priority = 0;
    }
    plan.scheduling = "SCHED_OTHER: this user may not use SCHED_FIFO, so timing is at the mercy of what else runs; as "
                      "root, or with `rtprio` in /etc/security/limits.conf, it is not";
}

std::string to_text(RunPlan const& plan) {
    std::string out = fmt::format("scenario {}, {} simulated, {}\n", plan.scenario, human_duration(plan.duration_s),
                                  plan.namespaces ? "in its own network namespaces" : "on the loopback interface");
    if (plan.namespaces) {
        out += "\nhosts\n";
        for (std::string const& host : plan.hosts) {
            out += fmt::format("  {}\n", host);
            for (Port const& port : plan.ports) {
                if (port.host == host) {
                    out +=
                        fmt::format("    {:<15} {}  {}\n", port.interface, port.mac,
                                    port.address.empty() ? "no IP" : fmt::format("{}/{}", port.address, port.prefix));
                }
            }
        }
    }
    for (PlacedBump const& bump : plan.bumps) {
        out += fmt::format("  {} sits between {} and {}\n", bump.process, bump.host, bump.link);
    }
    out += "\nprocesses\n";
    for (PlannedProcess const& process : plan.processes) {
        out += fmt::format("  {:<12} on {:<12} {}\n", process.name, process.host, join(process.command, " "));
        if (!process.interface.empty()) {
            out += fmt::format("    takes the interface '{}' of this machine into its host\n", process.interface);
        }
    }
    for (auto const& process_actions : plan.holds) {
        for (ProcessAction const& action : process_actions) {
            out += fmt::format("  at {} s: {} acts on {}\n", shortest(action.at_s), action.event, action.process);
        }
    }
    return out;
}

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/scenario_check.hpp"

#include "common/text.hpp"
#include "launcher/scenario/addresses.hpp"
#include "launcher/scenario/attacks.hpp"
#include "launcher/scenario/dataflow.hpp"
#include "launcher/scenario/expectation_check.hpp"
#include "launcher/scenario/impairments.hpp"
#include "launcher/scenario/installation.hpp"
#include "launcher/scenario/own_topics.hpp"
#include "launcher/scenario/run_on.hpp"
#include "launcher/scenario/wire_use.hpp"
#include "sim/app/engine_factory.hpp"
#include "sim/powerflow/power_flow.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;

template <class T>
std::vector<std::string> names_of(std::vector<T> const& elements) {
    std::vector<std::string> out;
    for (T const& element : elements) {
        out.push_back(element.name.name);
    }
    return out;
}

void must_exist(Ref const& ref, std::vector<std::string> const& names, std::string const& sentence,
                Diagnostics& diagnostics, bool whole_section_is_missing = false) {
    if (ref.empty() || (names.empty() && whole_section_is_missing) ||
        std::find(names.begin(), names.end(), ref.name) != names.end()) {
        return;
    }
    diagnostics.error(ref.where, fmt::format("{} '{}', which does not exist", sentence, ref.name),
                      spelling_hint(ref.name, names), static_cast<int>(ref.name.size()));
}

void check_references(Scenario const& s, Diagnostics& diagnostics) {
    std::vector<std::string> const links = names_of(s.links), hosts = names_of(s.hosts),
                                   processes = names_of(s.processes);
    for (Host const& host : s.hosts) {
        for (Ref const& link : host.links) {
            must_exist(link, links, fmt::format("host '{}' is plugged into", host.name.name), diagnostics);
        }
    }
    for (Process const& process : s.processes) {
        must_exist(process.host, hosts, fmt::format("process '{}' runs on", process.name.name), diagnostics, true);
    }
    for (sim::Event const& event : s.events) {
        for (Ref const* process : {&event.desynchronise, &event.resynchronise}) {
            must_exist(*process, processes, fmt::format("event '{}' acts on the process", event.name.name),
                       diagnostics);
            Process const* target = process->empty() ? nullptr : s.find_process(process->name);
            if (target != nullptr && target->program.name != "gridspace-mu") {
                diagnostics.error(process->where,
                                  fmt::format("event '{}' acts on the clock of '{}', which is no merging unit",
                                              event.name.name, process->name),
                                  "only gridspace-mu has a clock that can be lost",
                                  static_cast<int>(process->name.size()));
            }
        }
        for (Ref const* process : {&event.kill, &event.pause, &event.resume, &event.restart}) {
            must_exist(*process, processes, fmt::format("event '{}' acts on the process", event.name.name),
                       diagnostics);
            Process const* target = process->empty() ? nullptr : s.find_process(process->name);
            std::string const program = target == nullptr ? "" : target->program.name;
            if (program == "gridspace-sim" || program == "gridspace-recorder") {
                diagnostics.error(process->where,
                                  fmt::format("event '{}' acts on '{}', the {} of the run", event.name.name,
                                              process->name, program == "gridspace-sim" ? "simulator" : "recorder"),
                                  "a run cannot go on without it", static_cast<int>(process->name.size()));
            }
        }
    }
    check_impairment_events(s, diagnostics);
    if (s.network) {
        check_events(s.events, *s.network, s.simulation.solver != sim::SolverKind::phasor, diagnostics);
    }
}

void check_simulators(Scenario const& s, Diagnostics& diagnostics) {
    Process const* first = nullptr;
    for (Process const& process : s.processes) {
        if (process.program.name != "gridspace-sim") {
            continue;
        }
        if (first != nullptr) {
            diagnostics.error(process.name.where, fmt::format("'{}' is a second simulator", process.name.name),
                              fmt::format("'{}' is the first; one publishes the clock", first->name.name),
                              static_cast<int>(process.name.name.size()));
        }
        first = first == nullptr ? &process : first;
    }
    if (first == nullptr && !s.processes.empty()) {
        diagnostics.error(s.processes.front().name.where, "no process is a simulator",
                          "one needs `program: gridspace-sim`");
    }
}

void check_times(Scenario const& s, Diagnostics& diagnostics) {
    config::Node const* simulation = s.resolved.find("simulation");
    config::Node const* clock = s.resolved.find("clock");
    if (simulation == nullptr || clock == nullptr || !simulation->is_map() || !clock->is_map()) {
        return;
    }
    if (s.clock.tick_s && s.clock.tick_samples) {
        diagnostics.error(clock->where, "the clock has both tick_s and tick_samples", "one of them is enough");
    }
    if (s.clock.tick_samples && s.simulation.sampling.find("rate_hz") == nullptr) {
        diagnostics.error(clock->find("tick_samples")->where, "tick_samples needs simulation.sampling.rate_hz");
    }
    auto const place = [](config::Node const& map, std::initializer_list<char const*> keys) {
        for (char const* key : keys) {
            if (config::Node const* value = map.find(key)) {
                return value->where;
            }
        }
        return map.where;
    };
    config::SourceMark const at_tick = place(*clock, {"tick_s", "tick_samples"}),
                             at_duration = place(*simulation, {"duration_s", "duration_h"});
    Rational const tick = s.tick_s(), step = s.simulation.step_s;
    bool const tick_in_steps = (tick / step).is_whole(), step_in_ticks = (step / tick).is_whole();
    if (!tick_in_steps && !step_in_ticks) {
        diagnostics.error(at_tick,
                          fmt::format("a tick of {} s and a step of {} s do not divide each other", tick.to_string(),
                                      step.to_string()),
                          "make one a whole multiple of the other");
    }
    Rational const duration = s.simulation.duration();
    if (duration > Rational{0} && !(duration / tick).is_whole()) {
        diagnostics.error(at_duration, fmt::format("the duration of {} s is not a whole number of ticks of {} s",
                                                   duration.to_string(), tick.to_string()));
    }
    if (duration > Rational{0} && !(duration / step).is_whole()) {
        diagnostics.error(at_duration, fmt::format("the duration of {} s is not a whole number of steps of {} s",
                                                   duration.to_string(), step.to_string()));
    }
    if (s.quantum_s() < Rational{2, 1'000'000'000}) {
        diagnostics.error(clock->where,
                          fmt::format("step and tick have only {} s in common", s.quantum_s().to_string()),
                          "time stamps are exact down to 2 ns");
    }
    for (sim::Event const& event : s.events) {
        if (event.at_s && duration > Rational{0} && *event.at_s > duration) {
            diagnostics.warning(event.name.where,
                                fmt::format("event '{}' at {} s never happens: the run ends at {} s", event.name.name,
                                            shortest(event.at_s->to_double()), shortest(duration.to_double())),
                                "", static_cast<int>(event.name.name.size()));
        }
    }
}

/// The roles for which there are QoS profiles.
std::vector<std::string> qos_roles() {
    std::vector<std::string> roles;
    std::error_code ignored;
    for (auto const& file : std::filesystem::directory_iterator{qos_file("simulator").parent_path(), ignored}) {
        if (file.path().extension() == ".xml") {
            roles.push_back(file.path().stem().string());
        }
    }
    std::sort(roles.begin(), roles.end());
    return roles;
}

void check_programs(Scenario const& s, Diagnostics& diagnostics) {
    check_run_on(s, diagnostics);
    for (Process const& process : s.processes) {
        if (process.program.name != "exec" && !process.qos.empty() &&
            !std::filesystem::exists(qos_file(process.qos.name))) {
            diagnostics.error(process.qos.where, fmt::format("there is no QoS role '{}'", process.qos.name),
                              spelling_hint(process.qos.name, qos_roles()), static_cast<int>(process.qos.name.size()));
        }
        if (s.clock.mode == bus::ClockMode::lockstep && process.settings && process.is_foreign() &&
            !process.settings->is_member() && !process.settings->writes(s, process).empty()) {
            diagnostics.error(
                process.name.where,
                fmt::format("process '{}' writes topics, but is not a member of the lockstep clock", process.name.name),
                "`member: true` when it follows the protocol (docs/reference/lockstep_protocol.md), or a realtime "
                "clock");
        }
    }
}

/// A stream that two processes publish, or that somebody waits for and nobody publishes, is rarely meant.
void check_publishers(Scenario const& s, Diagnostics& diagnostics) {
    std::map<std::string, Process const*> publishers;
    std::map<std::string, Process const*> subscribers;
    bool strangers = false; // who may publish what no process declares
    for (Process const& process : s.processes) {
        strangers = strangers || process.is_foreign() || !process.interface.empty();
        if (!process.settings || process.program.name == "gridspace-attacker") {
            continue;
        }
        for (WireUse const& use : frames_sent(s, process)) {
            auto const [first, alone] = publishers.try_emplace(use.stream, &process);
            if (!use.stream.empty() && !alone && first->second != &process) {
                diagnostics.warning(
                    process.name.where,
                    fmt::format("'{}' publishes the stream '{}', as '{}' does", process.name.name, use.stream,
                                first->second->name.name),
                    "who receives it cannot tell them apart; an attack that is meant stands in `attacks`",
                    static_cast<int>(process.name.name.size()));
            }
        }
        for (WireUse const& use : frames_received(s, process)) {
            subscribers.try_emplace(use.stream, &process);
        }
    }
    for (auto const& [stream, process] : subscribers) {
        if (!stream.empty() && !strangers && !publishers.contains(stream)) {
            diagnostics.warning(
                process->name.where,
                fmt::format("'{}' waits for the stream '{}', and nobody publishes it", process->name.name, stream), "",
                static_cast<int>(process->name.name.size()));
        }
    }
}

bool exchanges_raw_frames(Scenario const& s, Process const& process) {
    return process.is_foreign() || !frames_sent(s, process).empty() || !frames_received(s, process).empty();
}

/// Two networks are for who exchanges frames; who does is asked by check_raw_link().
void check_doubly_attached(Scenario const& s, Diagnostics& diagnostics) {
    for (Process const& process : s.processes) {
        if (!process.prp.empty() && process.settings != nullptr && !exchanges_raw_frames(s, process)) {
            diagnostics.error(process.prp.front().where,
                              fmt::format("process '{}' exchanges no raw frames, and has `prp`", process.name.name),
                              "`prp:` is for devices on a process bus",
                              static_cast<int>(process.prp.front().name.size()));
        }
        if (!process.prp.empty() && process.settings != nullptr) {
            check_room_for_trailers(s, process, diagnostics);
        }
    }
}

/// Real interfaces instead of the scenario's links.
void check_interfaces(Scenario const& s, Diagnostics& diagnostics) {
    std::map<std::string, Process const*> users;
    for (Process const& process : s.processes) {
        if (process.interface.empty() || process.settings == nullptr) {
            continue;
        }
        config::Node const* written = process.node.find("interface");
        config::SourceMark const where = written == nullptr ? process.name.where : written->where;
        int const width = static_cast<int>(process.interface.size());
        if (!exchanges_raw_frames(s, process) || process.program.name == "gridspace-recorder") {
            diagnostics.error(where,
                              fmt::format("process '{}' exchanges no raw frames, and has the interface '{}'",
                                          process.name.name, process.interface),
                              "`interface:` is for devices on a process bus", width);
        } else if (s.clock.mode == bus::ClockMode::lockstep) {
            diagnostics.error(where,
                              fmt::format("process '{}' is on the real interface '{}', and the clock is in lockstep",
                                          process.name.name, process.interface),
                              "nobody can wait for a real network: clock: {mode: realtime}", width);
        }
        auto const [it, first] = users.try_emplace(process.interface, &process);
        if (!first && it->second->host != process.host) {
            diagnostics.error(where,
                              fmt::format("the interface '{}' is in the host '{}' already, for '{}'", process.interface,
                                          it->second->host.name, it->second->name.name),
                              "an interface can be in one host only", width);
        }
    }
}

/// The operating point at the start must exist, and the solver must take the network and begin there. False: it was
/// said that it does not.
bool check_physics(Scenario const& s, Diagnostics& diagnostics) {
    if (!s.network) {
        return true;
    }
    auto const refuse = [&](Error const& error) {
        diagnostics.error(s.simulation.network_mark, error.message, error.remedy);
        return false;
    };
    sim::PowerFlowOptions options;
    options.start_hour_of_day = sim::start_hour_of_day(s.simulation);
    auto const flow = solve_power_flow(*s.network, sim::SwitchState{*s.network}, options);
    if (!flow) {
        return refuse(flow.error());
    }
    if (s.simulation.step_s <= Rational{0}) {
        return true; // said elsewhere
    }
    auto const engine = sim::make_engine(s.simulation, *s.network, TimeBase{s.simulation.step_s});
    auto const started = engine ? (*engine)->initialise() : std::unexpected{engine.error()};
    if (!started) {
        return refuse(started.error());
    }
    if (auto const warning = sim::step_warning(s.simulation, *s.network)) {
        config::Node const* simulation = s.resolved.find("simulation");
        config::Node const* step = simulation == nullptr ? nullptr : simulation->find("step_s");
        diagnostics.warning(step == nullptr ? s.simulation.network_mark : step->where, warning->message, warning->hint);
    }
    return true;
}

} // namespace

void check_scenario(Scenario& s, Diagnostics& diagnostics) {
    check_references(s, diagnostics);
    check_simulators(s, diagnostics);
    check_times(s, diagnostics);
    check_programs(s, diagnostics);
    check_addresses(s, diagnostics);
    check_doubly_attached(s, diagnostics);
    check_interfaces(s, diagnostics);
    bool const simulates = check_physics(s, diagnostics);
    check_attacks(s, diagnostics);
    bool const readable =
        std::all_of(s.processes.begin(), s.processes.end(), [](Process const& p) { return p.settings != nullptr; });
    for (Process& process : s.processes) {
        if (process.settings != nullptr) {
            process.settings->check(s, process, diagnostics);
        }
    }
    if (readable && // the rest would only repeat what was said
        s.simulator() != nullptr && s.network && simulates) {
        check_own_topics(s, diagnostics);
        check_security(s, diagnostics);
        check_dataflow(s, diagnostics);
        KnownSignals const known{s};
        check_expectations(s, known, diagnostics);
        check_report(s.report, s.file.string(), known, diagnostics);
        check_comtrade(s, diagnostics);
    }
    if (readable && diagnostics.ok()) {
        check_publishers(s, diagnostics);
    }
}

} // namespace gridspace::launcher

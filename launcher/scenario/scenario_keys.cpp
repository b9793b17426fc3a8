// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/scenario_keys.hpp"

#include "common/text.hpp"
#include "launcher/judge/published.hpp"
#include "launcher/scenario/declared_program.hpp"
#include "launcher/scenario/foreign_programs.hpp"
#include "launcher/scenario/wire_programs.hpp"

#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;

void describe_clock(Fields& f, ClockSettings& c) {
    f.choice<bus::ClockMode>(
        "mode", c.mode, {{"realtime", bus::ClockMode::realtime}, {"lockstep", bus::ClockMode::lockstep}},
        {.doc = "lockstep: the simulator waits for its members; realtime: for nobody", .required = true});
    std::string speed = c.mode == bus::ClockMode::realtime ? "1" : "max";
    f.text("speed", speed,
           {.doc = "simulated seconds per second, or max (lockstep only, and its default; in real time 1)"});
    if (speed == "max") {
        c.speed = 0;
        if (c.mode == bus::ClockMode::realtime) {
            f.error("speed", "a real-time clock needs a pace", "a number: 1 is real time, 60 a minute per second");
        }
    } else if (auto const pace = Rational::parse(speed); pace && *pace > Rational{0}) {
        c.speed = pace->to_double();
    } else {
        f.error("speed", fmt::format("clock.speed is '{}'", speed), "expected a number > 0, or max");
    }
    f.fraction("tick_s", c.tick_s, {.doc = "simulated time between two clock samples", .above = 0});
    std::string samples;
    f.text("tick_samples", samples,
           {.doc = "the same in samples of the sampling rate; auto: the longest tick that every loop allows"});
    c.tick_samples_auto = samples == "auto";
    if (auto const number = Rational::parse(samples); number && number->is_whole() && *number >= Rational{1}) {
        c.tick_samples = number->num();
    } else if (!samples.empty() && !c.tick_samples_auto) {
        f.error("tick_samples", fmt::format("clock.tick_samples is '{}'", samples),
                "expected an integer >= 1, or auto");
    }
    f.flag(
        "shared_memory", c.shared_memory,
        {.doc = "lockstep: clock and acknowledgements among the processes of this machine go through shared memory"});
    f.number("member_timeout_s", c.member_timeout_s,
             {.doc = "how long a member may take for a tick before the run is stalled; 0: no limit", .min = 0});
    f.number("start_timeout_s", c.start_timeout_s,
             {.doc = "how long the start may stand still before everybody is ready; 0: no limit", .min = 0});
    f.choice<bool>(
        "scheduling", c.fifo, {{"fifo", true}, {"normal", false}},
        {.doc = "realtime: processes of the chain under SCHED_FIFO where that is permitted, or as all others"});
    f.choice<bool>("processors", c.awake, {{"awake", true}, {"sleep", false}},
                   {.doc = "realtime, and lockstep at full speed: idle processors of the machine stay awake where that "
                           "is permitted, or go to sleep as usual"});
    std::string start_at;
    f.text("start_at", start_at,
           {.doc = "utc_second: in real time, simulated time 0 (and so smpCnt 0) is a whole second of UTC; up to a "
                   "second is waited for it"});
    c.start_at_utc_second = start_at == "utc_second";
    if (!start_at.empty() && start_at != "utc_second") {
        f.error("start_at", fmt::format("clock.start_at is '{}'", start_at), "expected utc_second");
    }
}

void describe_record(Fields& f, RecordSettings& r) {
    std::string samples = "all";
    f.text("samples", samples, {.doc = "all or none"});
    r.samples = samples != "none";
    if (samples != "all" && samples != "none") {
        f.error("samples", fmt::format("record.samples is '{}'", samples), "expected all or none");
    }
    f.text("frames", r.frames, {.doc = "all or none"});
    std::vector<Ref> patterns;
    f.references("signals", patterns,
                 {.doc = "patterns of the simulator's signals that are published; all when not given"});
    if (!patterns.empty()) {
        r.signals.clear();
    }
    for (Ref& pattern : patterns) {
        r.signals.push_back(std::move(pattern.name));
    }
    ComtradeSettings comtrade;
    if (f.object("comtrade", {.doc = "waveform files around trips, in RUN/comtrade"},
                 [&](Fields& c) { describe(c, comtrade); })) {
        r.comtrade = std::move(comtrade);
    }
}

void describe_process(Fields& f, Process& p) {
    if (Node const* program = p.node.find("program"); program == nullptr || !program->is_map()) {
        f.reference("program", p.program, {.doc = "what is started", .required = true});
    }
    f.reference("host", p.host, {.doc = "where it runs", .required = true});
    f.reference("qos", p.qos, {.doc = "role: qos/<role>.xml"});
    f.text("run_on", p.run_on,
           {.doc = "native, qemu-user, qemu-system, ssh:USER@HOST:PORT, or external: somebody else starts it"});
    f.object("ssh", {.doc = "how the board of `run_on: ssh:HOST` is reached"}, [&](Fields& g) { describe(g, p.ssh); });
    std::int64_t cpu = -1;
    f.integer("cpu", cpu, {.doc = "processor it is bound to", .min = 0, .max = 1023});
    if (cpu >= 0) {
        p.cpu = cpu;
    }
    f.text("interface", p.interface, {.doc = "a real network interface instead of the scenario's links"});
    f.reference(
        "link", p.link,
        {.doc = "the link on which it exchanges raw frames; needed where the host is plugged into several without IP"});
    f.references("prp", p.prp, {.doc = "instead of `link`: networks A and B of a doubly attached node (IEC 62439-3)"});
    f.references(
        "capture", p.capture,
        {.doc =
             "recorder: links whose frames are captured; without it every link, in lockstep those with SV or GOOSE"});
    std::string label;
    f.text("label", label, {.doc = "display text"});
}

void describe_host(Fields& f, Host& host) {
    f.references("links", host.links, {.doc = "switches it is plugged into"});
    f.map("plugs",
          {.doc = "by link (or mgmt0, the management network): what is plugged into the switch in the place of this "
                  "host"},
          [&](Ref const& link, Fields& g) {
              std::string interface;
              g.text("interface", interface,
                     {.doc = "a real network interface of this machine, which leads to the board", .required = true});
              host.plugs.emplace_back(link, std::move(interface));
          });
}

void describe_link(Fields& f, Link& link) {
    std::string kind = "switch";
    f.text("kind", kind, {.doc = "switch"});
    if (kind != "switch") {
        f.error("kind", fmt::format("link '{}' is a '{}'", link.name.name, kind), "expected switch");
    }
    f.text("ipv4", link.ipv4, {.doc = "addresses on it, for example 10.10.0.0/24; none: no IP"});
    f.number("delay_us", link.delay_us, {.doc = "0: a switch does not delay; cables do, see `impairments`", .min = 0});
    if (link.delay_us > 0) {
        f.error(
            "delay_us", fmt::format("the switch '{}' cannot delay frames", link.name.name),
            fmt::format("delay the cables: `impairments: {{slow: {{place: {{between: [HOST, {}]}}, delay_us: {}}}}}`",
                        link.name.name, shortest(link.delay_us)));
    }
}

/// The keys that are the program's own.
void read_program(Fields& p, Process& process, ForeignPrograms& foreign, Diagnostics& diagnostics) {
    if (Node const* own = process.node.find("program"); own != nullptr && own->is_map()) {
        process.program.where = own->where;
        process.settings = foreign.read(p, process.node, process.program.name, diagnostics);
        if (auto const* declared = dynamic_cast<DeclaredSettings const*>(process.settings.get());
            declared != nullptr && process.qos.empty()) {
            process.qos = {declared->declaration().role, process.name.where};
        }
    } else if (Program const* program = find_program(process.program.name)) {
        process.settings = program->read(p);
        if (process.qos.empty()) {
            process.qos = {std::string{program->default_role}, process.name.where};
        }
    } else if (!process.program.empty()) {
        p.error("program",
                fmt::format("process '{}': there is no program '{}'", process.name.name, process.program.name),
                spelling_hint(process.program.name, program_names()));
        Node rest;
        for (Node::Entry const& entry : process.node.entries) {
            p.raw(entry.key, rest); // its own keys cannot be judged
        }
    }
}

} // namespace

void describe_scenario(Fields& f, Scenario& s, Node const& root, bool start_programs, Diagnostics& diagnostics) {
    std::int64_t version = 1;
    f.integer("gridspace", version, {.doc = "version of this format", .required = true, .min = 1, .max = 1});
    f.text("name", s.name, {.doc = "name of the scenario", .required = true});
    f.text("description", s.description, {.doc = "what it shows"});
    f.integer("seed", s.seed, {.doc = "of everything random in the run"});
    f.object("simulation", {.doc = "what is simulated", .required = true},
             [&](Fields& g) { describe(g, s.simulation); });
    f.object("clock", {.doc = "the simulation clock", .required = true},
             [&](Fields& g) { describe_clock(g, s.clock); });
    f.map("hosts", {.doc = "machines of the scenario: one network namespace each", .required = true},
          [&](Ref const& name, Fields& h) {
              s.hosts.emplace_back().name = name;
              describe_host(h, s.hosts.back());
          });
    f.map("links", {.doc = "Ethernet switches"}, [&](Ref const& name, Fields& l) {
        s.links.emplace_back().name = name;
        describe_link(l, s.links.back());
    });
    Node defaults;
    f.raw("defaults", defaults, {.doc = "settings by program; a process may override them"});
    ForeignPrograms foreign{start_programs};
    f.map("processes", {.doc = "what is started", .required = true}, [&](Ref const& name, Fields& p) {
        Process process;
        process.name = name;
        process.node = *root.find("processes")->find(name.name);
        describe_process(p, process);
        read_program(p, process, foreign, diagnostics);
        s.processes.push_back(std::move(process));
    });
    describe_events(f, s.events);
    Published published; // read again by the report, from the resolved scenario
    f.object("published", {.doc = "what a publication says about the same study: shown beside the results"},
             [&](Fields& p) { describe(p, published); });
    f.object("record", {.doc = "what is recorded"}, [&](Fields& r) { describe_record(r, s.record); });
    SecuritySettings security;
    if (f.object("security", {.doc = "DDS Security for the run; `on`: with all defaults"},
                 [&](Fields& g) { describe(g, security); })) {
        s.security = std::move(security);
    }
    std::vector<Ref> notes;
    f.references("notes", notes, {.doc = "assumptions taken, shown in the report"});
    Node streams;
    f.raw("streams", streams, {.doc = "SMV and GOOSE streams"});
    s.streams = streams::read_streams(streams, diagnostics);
    f.map("impairments",
          {.doc = "bad cables, by name; each is a process of the program gridspace-link on a host of its own"},
          [&](Ref const&, Fields& i) {
              (void)read_link(i);
          }); // for the schema: they have become processes before they are read
    attacker::describe_attacks(f, s.attacks);
    f.raw("expect", s.expect, {.doc = "what must hold for the run to pass (docs/how_to/write_a_scenario.md)"});
    f.object("report", {.doc = "what the report draws; without it, the usual figures"},
             [&](Fields& g) { describe(g, s.report, diagnostics); });
}

void describe_scenario_keys(config::Fields& fields) {
    Scenario scenario;
    Diagnostics ignored;
    Node root = Node::map(), processes = Node::map();
    processes.set("NAME", Node::map());
    root.set("processes", std::move(processes));
    describe_scenario(fields, scenario, root, false, ignored);
}

} // namespace gridspace::launcher

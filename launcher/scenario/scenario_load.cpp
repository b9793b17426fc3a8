// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/merge.hpp"
#include "common/config/yaml.hpp"
#include "common/text.hpp"
#include "launcher/judge/published.hpp"
#include "launcher/scenario/attacks.hpp"
#include "launcher/scenario/dataflow.hpp"
#include "launcher/scenario/declared_program.hpp"
#include "launcher/scenario/impairments.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/scenario_check.hpp"
#include "launcher/scenario/tick_length.hpp"
#include "launcher/scenario/wire_programs.hpp"
#include "sim/app/engine_factory.hpp"

#include <algorithm>
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
    f.text("speed", speed, {.doc = "simulated seconds per second, or max"});
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

/// The whole file, by the programs that it names.
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
              Host host;
              host.name = name;
              h.references("links", host.links, {.doc = "switches it is plugged into"});
              h.map("plugs",
                    {.doc = "by link (or mgmt0, the management network): what is plugged into the switch in the place "
                            "of this host"},
                    [&](Ref const& link, Fields& g) {
                        std::string interface;
                        g.text("interface", interface,
                               {.doc = "a real network interface of this machine, which leads to the board",
                                .required = true});
                        host.plugs.emplace_back(link, std::move(interface));
                    });
              s.hosts.push_back(std::move(host));
          });
    f.map("links", {.doc = "Ethernet switches"}, [&](Ref const& name, Fields& l) {
        Link link;
        link.name = name;
        std::string kind = "switch";
        l.text("kind", kind, {.doc = "switch"});
        if (kind != "switch") {
            l.error("kind", fmt::format("link '{}' is a '{}'", name.name, kind), "expected switch");
        }
        l.text("ipv4", link.ipv4, {.doc = "addresses on it, for example 10.10.0.0/24; none: no IP"});
        l.number("delay_us", link.delay_us,
                 {.doc = "0: a switch does not delay; cables do, see `impairments`", .min = 0});
        if (link.delay_us > 0) {
            l.error("delay_us", fmt::format("the switch '{}' cannot delay frames", name.name),
                    fmt::format(
                        "delay the cables: `impairments: {{slow: {{place: {{between: [HOST, {}]}}, delay_us: {}}}}}`",
                        name.name, shortest(link.delay_us)));
        }
        s.links.push_back(std::move(link));
    });
    Node defaults;
    f.raw("defaults", defaults, {.doc = "settings by program; a process may override them"});
    ForeignPrograms foreign{start_programs};
    f.map("processes", {.doc = "what is started", .required = true}, [&](Ref const& name, Fields& p) {
        Process process;
        process.name = name;
        process.node = *root.find("processes")->find(name.name);
        describe_process(p, process);
        if (Node const* own = process.node.find("program"); own != nullptr && own->is_map()) {
            process.program.where = own->where;
            process.settings = foreign.read(p, process.node, process.program.name, diagnostics);
            if (auto const* declared = dynamic_cast<DeclaredSettings const*>(process.settings.get());
                declared != nullptr && process.qos.empty()) {
                process.qos = {declared->declaration().role, name.where};
            }
        } else if (Program const* program = find_program(process.program.name)) {
            process.settings = program->read(p);
            if (process.qos.empty()) {
                process.qos = {std::string{program->default_role}, name.where};
            }
        } else if (!process.program.empty()) {
            p.error("program", fmt::format("process '{}': there is no program '{}'", name.name, process.program.name),
                    spelling_hint(process.program.name, program_names()));
            Node rest;
            for (Node::Entry const& entry : process.node.entries) {
                p.raw(entry.key, rest); // its own keys cannot be judged
            }
        }
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
    f.raw("expect", s.expect, {.doc = "what must hold for the run to pass"});
    f.object("report", {.doc = "what the report draws; without it, the usual figures"},
             [&](Fields& g) { describe(g, s.report, diagnostics); });
}

/// `defaults:` by program, laid under each process.
void apply_defaults(Node& root, Diagnostics& diagnostics) {
    Node const* defaults = root.find("defaults");
    Node* processes = root.find("processes");
    if (defaults == nullptr || processes == nullptr || !defaults->is_map()) {
        return;
    }
    for (Node::Entry const& entry : defaults->entries) {
        if (find_program(entry.key) == nullptr) {
            diagnostics.error(entry.where,
                              fmt::format("defaults for the program '{}', which does not exist", entry.key),
                              did_you_mean(entry.key, program_names()), static_cast<int>(entry.key.size()));
        }
    }
    for (Node::Entry& process : processes->entries) {
        Node const* program = process.value.find("program");
        Node const* base = program == nullptr ? nullptr : defaults->find(program->text);
        if (base != nullptr && base->is_map()) {
            Node merged = *base;
            merged.where = process.value.where;
            config::merge(merged, process.value);
            process.value = std::move(merged);
        }
    }
}

/// Command-line options become overrides of the tree, so that scenario.resolved.yaml says what was run.
void apply_options(Node& root, LoadOptions const& options, Diagnostics& diagnostics) {
    int number = 0;
    for (std::string const& assignment : options.set) {
        config::apply_set(root, assignment, ++number, diagnostics);
    }
    auto const option = [&](std::string const& name, std::string const& path, std::string const& value) {
        Diagnostics own;
        config::apply_set(root, path + "=" + value, 0, own);
        if (!own.ok()) {
            diagnostics.error({config::make_source(name, value), 0, 0},
                              fmt::format("{} {} is not understood", name, value));
        }
    };
    if (options.speed) {
        option("--speed", "clock.speed", *options.speed == 0 ? "max" : shortest(*options.speed));
    }
    if (options.seed) {
        config::SourceMark const where{config::make_source("--seed", *options.seed), 1, 1};
        Node written = Node::map(where);
        written.set("seed", Node::scalar(*options.seed)).where = where;
        std::int64_t seed = 0; // read here for the place of a mistake, and later as any other value
        auto const errors = diagnostics.errors();
        config::read_fields(written, "", diagnostics, [&](Fields& f) { f.integer("seed", seed, {}); });
        if (diagnostics.errors() == errors) {
            option("--seed", "seed", *options.seed);
        }
    }
    if (options.until) {
        if (auto const until = parse_duration(*options.until)) {
            option("--until", "simulation.duration_h", "~");
            option("--until", "simulation.duration_s", until->to_string());
        } else {
            diagnostics.error({config::make_source("--until", *options.until), 0, 0},
                              fmt::format("'{}' is not a duration", *options.until), "for example 10s, 5min or 2h");
        }
    }
}

} // namespace

void describe_scenario_keys(config::Fields& fields) {
    Scenario scenario;
    Diagnostics ignored;
    Node root = Node::map(), processes = Node::map();
    processes.set("NAME", Node::map());
    root.set("processes", std::move(processes));
    describe_scenario(fields, scenario, root, false, ignored);
}

Process const* Scenario::find_process(std::string_view process) const {
    auto const it =
        std::find_if(processes.begin(), processes.end(), [&](Process const& p) { return p.name.name == process; });
    return it == processes.end() ? nullptr : &*it;
}

Process const* Scenario::simulator() const {
    auto const it = std::find_if(processes.begin(), processes.end(),
                                 [](Process const& p) { return p.program.name == "gridspace-sim"; });
    return it == processes.end() ? nullptr : &*it;
}

Rational Scenario::tick_s() const {
    if (clock.tick_s) {
        return *clock.tick_s;
    }
    if (clock.tick_samples) {
        if (Node const* rate = simulation.sampling.find("rate_hz")) {
            if (auto const hz = Rational::parse(rate->text); hz && *hz > Rational{0}) {
                return Rational{*clock.tick_samples} / *hz;
            }
        }
    }
    return simulation.step_s;
}

Rational Scenario::quantum_s() const {
    return common_divisor(simulation.step_s, tick_s());
}

std::vector<sim::Event> process_events(Scenario const& scenario) {
    std::vector<sim::Event> out;
    for (sim::Event const& event : scenario.events) {
        if (!event.kill.empty() || !event.pause.empty() || !event.resume.empty() || !event.restart.empty()) {
            out.push_back(event);
        }
    }
    std::stable_sort(out.begin(), out.end(), [](auto const& a, auto const& b) { return *a.at_s < *b.at_s; });
    return out;
}

/// `step_s: auto` becomes a number, for everybody who reads the scenario after that.
static void settle_step(Scenario& scenario) {
    if (scenario.simulation.step_auto) {
        sim::settle_step(scenario.simulation, *scenario.network, scenario.clock.tick_s);
        Node& simulation = *scenario.resolved.find("simulation");
        simulation.set("step_s",
                       Node::scalar(scenario.simulation.step_s.to_string(), simulation.find("step_s")->where));
    }
}

/// What the programs are; the simulator first, because attackers ask for its topics.
static void settle_programs(Scenario& scenario) {
    for (bool const simulators : {true, false}) {
        for (Process const& process : scenario.processes) {
            if (process.settings != nullptr && (process.program.name == "gridspace-sim") == simulators) {
                process.settings->settle(scenario, process);
            }
        }
    }
}

/// `tick_samples: auto` becomes a number, once it is known what the programs are.
static void settle_tick(Scenario& scenario) {
    bool const readable =
        scenario.simulator() != nullptr && scenario.simulation.sampling.find("rate_hz") != nullptr &&
        scenario.simulation.step_s > Rational{0} &&
        std::ranges::all_of(scenario.processes, [](Process const& p) { return p.settings != nullptr; });
    if (scenario.clock.tick_samples_auto) {
        scenario.clock.tick_samples = readable ? longest_tick_samples(scenario) : 1;
    }
}

std::unique_ptr<Scenario> load_scenario(std::filesystem::path const& file, LoadOptions const& options,
                                        Diagnostics& diagnostics) {
    auto root = config::load_extended(file, diagnostics);
    if (!root) {
        return nullptr;
    }
    if (config::Node::Entry const* version = root->find_entry("gridspace_network")) {
        diagnostics.error(version->where, "this is a network file, and a scenario is expected",
                          "run `gridspace powerflow` on it, or name it as simulation.network of a scenario");
        return nullptr;
    }
    if (config::Node::Entry const* version = root->find_entry("gridspace_study")) {
        diagnostics.error(version->where, "this is a study file, and a scenario is expected",
                          "run `gridspace sweep` on it, or give the file that its `scenario` names");
        return nullptr;
    }
    if (config::Node::Entry const* version = root->find_entry("gridspace_certify")) {
        diagnostics.error(version->where, "this is a case of a certification, and a scenario is expected",
                          "run `gridspace certify` on it, or give the file that its `scenario` names");
        return nullptr;
    }
    if (options.over != nullptr) {
        config::merge(*root, *options.over);
    }
    apply_options(*root, options, diagnostics);
    if (Node* streams = root->find("streams")) {
        config::resolve_likes(*streams, diagnostics);
    }
    expand_security_word(*root, diagnostics);
    expand_impairments(*root, diagnostics);
    apply_defaults(*root, diagnostics);
    spell_out_places(*root);
    auto scenario = std::make_unique<Scenario>();
    scenario->file = file;
    scenario->allow_attacks_on = options.allow_attacks_on;
    config::read_fields(*root, "", diagnostics, [&](Fields& f) {
        describe_scenario(f, *scenario, *root, options.start_programs, diagnostics);
    });
    scenario->resolved = std::move(*root);
    scenario->resolved.erase("defaults"); // they are in the processes now
    if (!scenario->simulation.network.empty()) {
        if (auto network = sim::load_simulated_network(scenario->simulation, diagnostics)) {
            scenario->network = std::make_shared<sim::Network const>(std::move(*network));
        }
    }
    if (scenario->network) {
        settle_step(*scenario);
    }
    settle_programs(*scenario);
    settle_tick(*scenario);
    check_scenario(*scenario, diagnostics);
    return diagnostics.ok() ? std::move(scenario) : nullptr;
}

} // namespace gridspace::launcher

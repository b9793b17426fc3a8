// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/merge.hpp"
#include "common/config/yaml.hpp"
#include "common/text.hpp"
#include "launcher/scenario/attacks.hpp"
#include "launcher/scenario/impairments.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/scenario_check.hpp"
#include "launcher/scenario/scenario_keys.hpp"
#include "launcher/scenario/tick_length.hpp"
#include "sim/app/engine_factory.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;

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

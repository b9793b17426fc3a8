// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace simulate: a network on its own, without a bus and other processes.
#include "common/config/yaml.hpp"
#include "common/text.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/engine_options.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/simulation_output.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/run/progress.hpp"
#include "sim/network/network_config.hpp"
#include "sim/phasor/phasor_engine.hpp"
#include "sim/runtime/simulation.hpp"
#include "sim/solvers/make_engine.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <unistd.h>

namespace gridspace::cli {
namespace {

struct SimulateArguments {
    std::filesystem::path network, events, csv, comtrade;
    EngineOptions engine;
    std::vector<std::string> signals; ///< patterns; empty: the usual ones
    std::int64_t every{1}, threads{1};
    bool timing{false}, quiet{false}, list_signals{false};
};

using Clock = std::chrono::steady_clock;

/// After so many steps somebody looks whether what was written are numbers.
constexpr std::int64_t kStepsBetweenChecks = 256;

std::optional<std::vector<sim::Event>> read_events(std::filesystem::path const& file, sim::Network const& network,
                                                   bool waveform, config::Diagnostics& diagnostics) {
    std::vector<sim::Event> events;
    if (file.empty()) {
        return events;
    }
    auto const root = config::load_yaml(file, diagnostics);
    if (!root) {
        return std::nullopt;
    }
    config::read_fields(*root, "", diagnostics, [&](config::Fields& f) { sim::describe_events(f, events); });
    if (diagnostics.ok()) {
        sim::check_events(events, network, waveform, diagnostics);
    }
    for (sim::Event const& e : events) {
        for (config::Ref const* process : {&e.kill, &e.pause, &e.resume, &e.restart}) {
            if (!process->empty()) {
                diagnostics.error(process->where,
                                  fmt::format("event '{}' acts on the process '{}', but there are no processes here",
                                              e.name.name, process->name));
            }
        }
        for (config::Ref const* unit : {&e.desynchronise, &e.resynchronise}) {
            if (!unit->empty()) {
                diagnostics.error(
                    unit->where,
                    fmt::format("event '{}' acts on the clock of '{}', but there are no merging units here",
                                e.name.name, unit->name));
            }
        }
    }
    return diagnostics.ok() ? std::optional{std::move(events)} : std::nullopt;
}

void print_timing(std::vector<float>& step_us, double simulated_s) {
    double total_s = 0;
    for (float const us : step_us) {
        total_s += 1e-6 * us;
    }
    std::sort(step_us.begin(), step_us.end());
    auto const at = [&](double share) {
        return step_us[std::min(step_us.size() - 1,
                                static_cast<std::size_t>(share * static_cast<double>(step_us.size())))];
    };
    fmt::print(stderr, "step wall time, us: p50 {:.2f}  p99 {:.2f}  p99.9 {:.2f}  max {:.2f}\n", at(0.5), at(0.99),
               at(0.999), step_us.back());
    fmt::print(stderr, "{} steps, {:.4g} s simulated in {:.3g} s without output: {:.1f} times real time\n",
               step_us.size(), simulated_s, total_s, simulated_s / total_s);
}

void warn_of_late_events(std::vector<sim::TimedAction> const& timeline, Rational until) {
    for (sim::TimedAction const& event : timeline) {
        if (event.at_s > until) {
            fmt::print(stderr, "warning: event '{}' at {} s comes after the end of the simulation ({} s)\n",
                       event.event, event.at_s.to_double(), until.to_double());
        }
    }
}

/// Every step and every event is a whole number of quanta: nothing is rounded to a grid.
Result<TimeBase> time_base(Rational step, std::vector<sim::TimedAction> const& timeline) {
    Rational quantum = step;
    try {
        for (sim::TimedAction const& t : timeline) {
            quantum = t.at_s > Rational{0} ? common_divisor(quantum, t.at_s) : quantum;
        }
    } catch (std::overflow_error const&) {
        return fail(ExitCode::usage, "the times of the events and the step have no common fraction",
                    "write them with fewer digits");
    }
    return TimeBase{quantum};
}

void list_signals(sim::Engine const& engine) {
    for (sim::SignalDef const& s : engine.signals()) {
        fmt::print("{:<36} {}\n", s.name, s.unit.empty() ? "-" : s.unit);
    }
}

/// Without channels.
ComtradeHeader comtrade_header(double frequency_hz, Rational step, std::int64_t every,
                               std::vector<sim::TimedAction> const& timeline) {
    ComtradeHeader header;
    header.line_frequency_hz = frequency_hz;
    header.sample_rate_hz = 1 / step.to_double() / static_cast<double>(every);
    // Simulated time 0 is 1970: a network alone has no epoch.
    header.trigger_unix_ns = timeline.empty() ? 0 : std::llround(timeline.front().at_s.to_double() * 1e9);
    return header;
}

Result<void> open_files(SimulationOutput& output, SimulateArguments const& a, ComtradeHeader header,
                        std::map<std::string, sim::Instrument::Ratio> const& ratios) {
    if (!a.csv.empty()) {
        if (auto ok = output.open_csv(a.csv); !ok) {
            return ok;
        }
    }
    return a.comtrade.empty() ? Result<void>{} : output.open_comtrade(a.comtrade, std::move(header), ratios);
}

/// What happens in the simulation, shown as in a run.
void show_events(sim::Simulation& run, TimeBase base, std::string const& solver, launcher::Progress& progress) {
    run.on_failure([&progress, base](SimTime t, std::string const& breaker) {
        progress.event(base.seconds(t), breaker, "fails_to_open", "told to open, and stays closed");
    });
    run.on_happening([&progress](sim::Happening const& h) { progress.event(h.at_s, h.element, h.event, h.text); });
    run.on_event([&progress, base, &solver](SimTime t, sim::TimedAction const& action) {
        progress.event(base.seconds(t), solver, "event", action.event);
    });
}

/// Until the end, or until something cannot be written. `step_us`: how long each step took, where that was asked for.
Result<void> run_to_end(sim::Simulation& run, SimulateArguments const& a, ChosenEngine const& chosen, TimeBase base,
                        SimulationOutput& output, launcher::Progress& progress, std::vector<float>& step_us) {
    std::int64_t count = 0;
    Clock::time_point before = Clock::now();
    auto const observer = [&](SimTime t) {
        if (a.timing) {
            if (count > 0) {
                step_us.push_back(std::chrono::duration<float, std::micro>(Clock::now() - before).count());
            }
        }
        if (count % a.every == 0) {
            output.row(base.seconds(t));
        }
        if (count++ % 4096 == 0) {
            progress.update(base.seconds(t), 0);
        }
        if (a.timing) {
            before = Clock::now();
        }
    };
    auto done = run.start(observer);
    SimTime const end = SimTime{} + base.nearest(chosen.until_s);
    SimSpan const stretch = base.nearest(chosen.settings.step_s) * kStepsBetweenChecks;
    for (SimTime t; done && output.state() && t < end;) {
        t = std::min(end, t + stretch);
        done = run.run_until(t, observer);
    }
    return done;
}

launcher::Progress::Style progress_style(bool quiet) {
    using Style = launcher::Progress::Style;
    return quiet ? Style::quiet : ::isatty(STDERR_FILENO) != 0 ? Style::terminal : Style::plain;
}

/// A network that has been read, on an engine that has been chosen.
int simulate(SimulateArguments const& a, sim::Network network, std::vector<sim::Event> const& events,
             ChosenEngine const& chosen) {
    Rational const step = chosen.settings.step_s;
    std::vector<sim::TimedAction> const timeline = sim::timeline(events);
    if (!a.list_signals) {
        warn_of_late_events(timeline, chosen.until_s);
    }
    auto const base = time_base(step, timeline);
    if (!base) {
        return print_error(base.error());
    }
    bool const emt = a.engine.solver == "emt";
    for (std::string const& unseen : emt ? std::vector<std::string>{} : sim::phasor::unseen_by_phasors(network)) {
        fmt::print(stderr, "note: {} (--solver emt does)\n", unseen);
    }
    ComtradeHeader header = comtrade_header(network.frequency_hz, step, a.every, timeline);
    std::string const name = network.name;
    auto const ratios = ratios_of(network);
    auto engine = sim::make_engine(chosen.settings, std::move(network), *base);
    if (!engine) {
        return print_error(engine.error());
    }
    if (a.list_signals) {
        list_signals(**engine);
        return 0;
    }
    auto const columns =
        choose(names_of((*engine)->signals()), a.signals,
               {"bus.*.v_pu", "machine.*.frequency_hz", "breaker.*.position", "fuse.*.position", "system.*"}, "signal",
               "--list-signals shows what there is");
    if (!columns) {
        return print_error(columns.error());
    }
    (*engine)->will_read(*columns);
    SimulationOutput output{**engine, *columns};
    if (auto ok = open_files(output, a, std::move(header), ratios); !ok) {
        return print_error(ok.error());
    }
    sim::Simulation run{std::move(*engine), {*base, base->nearest(step)}, timeline};
    for (sim::StuckBreaker const& stuck : sim::stuck_breakers(events)) {
        run.fail_to_open(stuck.breaker, SimTime{} + base->nearest(stuck.from_s));
    }
    launcher::Progress progress{progress_style(a.quiet), name, chosen.until_s.to_double()};
    show_events(run, *base, a.engine.solver, progress);
    std::vector<float> step_us;
    auto const done = run_to_end(run, a, chosen, *base, output, progress, step_us);
    progress.finish();
    auto const written = output.finish(a.csv);
    for (Result<void> const& ok : {done, output.state(), written}) {
        if (!ok) {
            return print_error(ok.error());
        }
    }
    if (!step_us.empty()) {
        print_timing(step_us, chosen.until_s.to_double());
    }
    return 0;
}

int simulate(SimulateArguments const& a) {
    config::Diagnostics diagnostics;
    auto network = sim::load_network(a.network, diagnostics);
    bool const emt = a.engine.solver == "emt";
    auto const events = network ? read_events(a.events, *network, emt, diagnostics) : std::nullopt;
    if (!network || !events) {
        fmt::print(stderr, "{}\n", diagnostics.render());
        return static_cast<int>(ExitCode::usage);
    }
    auto chosen = chosen_engine(a.engine);
    if (!chosen) {
        return print_error(chosen.error());
    }
    if (a.threads > 1 && !emt) {
        return print_error({ExitCode::usage, "--threads is for waveforms: phasors are stepped by one", "leave it out"});
    }
    chosen->settings.threads = a.threads;
    settle_step(chosen->settings, *network, a.quiet);
    return simulate(a, std::move(*network), *events, *chosen);
}

} // namespace

void add_simulate(Command app, Action& action) {
    auto const a = std::make_shared<SimulateArguments>();
    Command verb =
        app.add_subcommand("simulate", "simulate a network offline: waveforms or phasors to CSV or COMTRADE");
    verb.add_option("NETWORK", a->network, "network file (YAML or MATPOWER)").required();
    verb.add_option("--events", a->events, "YAML file with `events:` as in a scenario");
    engine_options(verb, a->engine);
    verb.add_option("--signals", a->signals, "what is written: names or patterns, separated by commas").delimiter(',');
    verb.add_flag("--list-signals", a->list_signals, "list what can be written, and end");
    verb.add_option("--csv", a->csv, "write a table: time_s first, one header row");
    verb.add_option("--comtrade", a->comtrade, "write NAME.cfg and NAME.dat (IEEE C37.111-2013, float32)");
    verb.add_option("--every", a->every, "write every n-th step").check(positive());
    verb.add_option("--threads", a->threads,
                    "emt: processors that step a large network together; the results are the same")
        .check(number(1, "a number of threads from 1 to 64", sim::kMostThreads));
    verb.add_flag("--timing", a->timing, "print wall time per step and the real-time factor");
    verb.add_flag("--quiet", a->quiet, "print nothing but errors");
    verb.callback([a, &action] { action = [a] { return simulate(*a); }; });
}

} // namespace gridspace::cli

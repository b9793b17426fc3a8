// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace simulate: a network on its own, without a bus and other processes.
#include "common/comtrade/comtrade_writer.hpp"
#include "common/config/yaml.hpp"
#include "common/text.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/engine_options.hpp"
#include "launcher/cli/load.hpp"
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
#include <fstream>
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

/// By the beginning of the transformer's signals ("ct.NAME", "vt.NAME").
std::map<std::string, sim::Instrument::Ratio> ratios_of(sim::Network const& n) {
    std::map<std::string, sim::Instrument::Ratio> out;
    sim::NetworkAround const around{n};
    for (sim::Instrument const* i : sim::all<sim::Instrument>(n)) {
        out[signal_prefix(*i)] = i->ratio(around);
    }
    return out;
}

/// What is written of the simulation, row by row.
class Output {
  public:
    Output(sim::Engine const& engine, std::vector<std::size_t> columns)
        : engine_{engine}, columns_{std::move(columns)}, values_(columns_.size()) {}

    Result<void> open_csv(std::filesystem::path const& file) {
        csv_.open(file);
        if (!csv_) {
            return fail(ExitCode::environment, fmt::format("cannot write {}", file.string()),
                        "does the folder exist, and may you write there?");
        }
        std::string header = "time_s";
        for (std::size_t const c : columns_) {
            header += "," + engine_.signals()[c].name;
        }
        csv_ << header << '\n';
        return {};
    }

    Result<void> open_comtrade(std::filesystem::path const& file, double frequency_hz, double rate_hz, double trigger_s,
                               std::map<std::string, sim::Instrument::Ratio> const& ratios) {
        ComtradeHeader header;
        header.line_frequency_hz = frequency_hz;
        header.sample_rate_hz = rate_hz;
        header.trigger_unix_ns =
            std::llround(trigger_s * 1e9); // simulated time 0 is 1970: a network alone has no epoch
        for (std::size_t const c : columns_) {
            sim::SignalDef const& s = engine_.signals()[c];
            std::string const tail = s.name.substr(s.name.rfind('.') + 1);
            std::string const phase = tail == "a" || tail == "b" || tail == "c" ? tail : "";
            if (!s.may_be_unknown) { // samples of a recording are numbers
                ComtradeChannel channel{s.name, phase, s.unit};
                if (auto const ratio = ratios.find(s.name.substr(0, s.name.find('.', 3))); ratio != ratios.end()) {
                    channel.primary = ratio->second.primary;
                    channel.secondary = ratio->second.secondary;
                }
                (s.unit == "dpc" ? header.digital : header.analog).push_back(std::move(channel));
            }
        }
        auto writer = ComtradeWriter::create(file, std::move(header));
        if (!writer) {
            return std::unexpected{writer.error()};
        }
        comtrade_.emplace(std::move(*writer));
        return {};
    }

    /// What cannot be written: the first value that is no number, where there should be one.
    [[nodiscard]] Result<void> const& state() const { return state_; }

    void row(double t) {
        if (!state_) {
            return;
        }
        for (std::size_t k = 0; k < columns_.size(); ++k) {
            values_[k] = engine_.value(columns_[k]);
            sim::SignalDef const& s = engine_.signals()[columns_[k]];
            if (!std::isfinite(values_[k]) && !s.may_be_unknown) {
                state_ = fail(ExitCode::usage, fmt::format("'{}' is {} at {} s", s.name, values_[k], t),
                              "the rows before that are written; look at the element there");
                return;
            }
        }
        if (csv_.is_open()) {
            line_.clear();
            fmt::format_to(std::back_inserter(line_), "{}", t);
            for (double const value : values_) {
                if (std::isfinite(value)) {
                    fmt::format_to(std::back_inserter(line_), ",{}", value);
                } else {
                    line_.push_back(','); // not known yet: an empty cell
                }
            }
            line_.push_back('\n');
            csv_.write(line_.data(), static_cast<std::streamsize>(line_.size()));
        }
        if (comtrade_) {
            analog_.clear();
            std::size_t digital = 0;
            for (std::size_t k = 0; k < columns_.size(); ++k) {
                sim::SignalDef const& s = engine_.signals()[columns_[k]];
                if (s.unit == "dpc") {
                    digital_[digital++] = values_[k] == 2; // closed
                } else if (!s.may_be_unknown) {
                    analog_.push_back(values_[k]);
                }
            }
            comtrade_->row(analog_, {digital_.get(), digital});
        }
    }

    Result<void> finish(std::filesystem::path const& csv) {
        if (csv_.is_open()) {
            csv_.close();
            if (!csv_) {
                return fail(ExitCode::environment, fmt::format("cannot write {}", csv.string()), "is the disk full?");
            }
        }
        return comtrade_ ? comtrade_->finish() : Result<void>{};
    }

  private:
    sim::Engine const& engine_;
    std::vector<std::size_t> columns_;
    std::vector<double> values_;
    Result<void> state_;
    std::ofstream csv_;
    std::optional<ComtradeWriter> comtrade_;
    std::string line_;
    std::vector<double> analog_;
    std::unique_ptr<bool[]> digital_{std::make_unique<bool[]>(columns_.size())};
};

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
    Rational const until = chosen->until_s, step = chosen->settings.step_s;
    std::vector<sim::TimedAction> const timeline = sim::timeline(*events);
    for (sim::TimedAction const& event : timeline) {
        if (event.at_s > until && !a.list_signals) {
            fmt::print(stderr, "warning: event '{}' at {} s comes after the end of the simulation ({} s)\n",
                       event.event, event.at_s.to_double(), until.to_double());
        }
    }
    // Every step and every event is a whole number of quanta: nothing is rounded to a grid.
    Rational quantum = step;
    try {
        for (sim::TimedAction const& t : timeline) {
            quantum = t.at_s > Rational{0} ? common_divisor(quantum, t.at_s) : quantum;
        }
    } catch (std::overflow_error const&) {
        return print_error({ExitCode::usage, "the times of the events and the step have no common fraction",
                            "write them with fewer digits"});
    }
    for (std::string const& unseen : emt ? std::vector<std::string>{} : sim::phasor::unseen_by_phasors(*network)) {
        fmt::print(stderr, "note: {} (--solver emt does)\n", unseen);
    }
    TimeBase const base{quantum};
    double const frequency_hz = network->frequency_hz;
    std::string const name = network->name;
    auto const ratios = ratios_of(*network);
    auto engine = sim::make_engine(chosen->settings, std::move(*network), base);
    if (!engine) {
        return print_error(engine.error());
    }
    if (a.list_signals) {
        for (sim::SignalDef const& s : (*engine)->signals()) {
            fmt::print("{:<36} {}\n", s.name, s.unit.empty() ? "-" : s.unit);
        }
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
    Output output{**engine, *columns};
    double const trigger_s = timeline.empty() ? 0 : timeline.front().at_s.to_double();
    if (!a.csv.empty()) {
        if (auto ok = output.open_csv(a.csv); !ok) {
            return print_error(ok.error());
        }
    }
    if (!a.comtrade.empty()) {
        if (auto ok = output.open_comtrade(a.comtrade, frequency_hz,
                                           1 / step.to_double() / static_cast<double>(a.every), trigger_s, ratios);
            !ok) {
            return print_error(ok.error());
        }
    }
    sim::Simulation run{std::move(*engine), {base, base.nearest(step)}, timeline};
    double const duration_s = until.to_double();
    using Style = launcher::Progress::Style;
    launcher::Progress progress{a.quiet                        ? Style::quiet
                                : ::isatty(STDERR_FILENO) != 0 ? Style::terminal
                                                               : Style::plain,
                                name, duration_s};
    for (sim::StuckBreaker const& stuck : sim::stuck_breakers(*events)) {
        run.fail_to_open(stuck.breaker, SimTime{} + base.nearest(stuck.from_s));
    }
    run.on_failure([&](SimTime t, std::string const& breaker) {
        progress.event(base.seconds(t), breaker, "fails_to_open", "told to open, and stays closed");
    });
    run.on_happening([&](sim::Happening const& h) { progress.event(h.at_s, h.element, h.event, h.text); });
    run.on_event([&](SimTime t, sim::TimedAction const& action) {
        progress.event(base.seconds(t), a.engine.solver, "event", action.event);
    });
    std::vector<float> step_us;
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
    SimTime const end = SimTime{} + base.nearest(until);
    SimSpan const stretch = base.nearest(step) * kStepsBetweenChecks;
    for (SimTime t; done && output.state() && t < end;) {
        t = std::min(end, t + stretch);
        done = run.run_until(t, observer);
    }
    progress.finish();
    auto const written = output.finish(a.csv);
    if (!done) {
        return print_error(done.error());
    }
    if (!output.state()) {
        return print_error(output.state().error());
    }
    if (!written) {
        return print_error(written.error());
    }
    if (a.timing && !step_us.empty()) {
        print_timing(step_us, duration_s);
    }
    return 0;
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

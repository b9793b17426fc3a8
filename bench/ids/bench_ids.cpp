// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The table of design choices of docs/design/ids.md: how a line relay fares with each kind of detector in front of it,
// on faults, disturbances and forgeries simulated with the waveform solver.
//
//   bench_ids [--faults 120] [--healthy 20] [--attacks 100] [--seed 1] [--threads 2] [--config configs/ids/bench.yaml]
#include "bench/ids/design.hpp"
#include "bench/ids/masquerade_timings.hpp"
#include "ids/evaluation/protection_trial.hpp"
#include "ids/scoring/interval.hpp"
#include "ids/training/chunks.hpp"
#include "launcher/ids/exploration.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <span>
#include <vector>

namespace gridspace {
namespace {

using ids::Situation;

struct Options {
    std::int64_t faults{120}, healthy{20}, attacks{100}, seed{1}, timings{0};
    int threads{2};
    std::filesystem::path config{"configs/ids/bench.yaml"}, models{"configs/models"};
};

int stop(Error const& error) {
    fmt::print(stderr, "error: {}\n", describe(error));
    return static_cast<int>(error.code);
}

std::string percentiles(std::vector<double> v) {
    if (v.empty()) {
        return "-";
    }
    std::sort(v.begin(), v.end());
    auto const at = [&](double p) { return v[static_cast<std::size_t>(p * static_cast<double>(v.size() - 1) + 0.5)]; };
    return fmt::format("{:.2f} / {:.2f} / {:.2f}", at(0.5), at(0.95), v.back());
}

/// Simulated once, judged by every design.
struct Recordings {
    /// Internal faults, then runs without, then quiet ones that attacks are put on.
    std::vector<ids::LineWaveform> all;
    std::size_t fault_count{0}, disturbed_count{0};

    [[nodiscard]] std::span<ids::LineWaveform const> faults() const { return std::span{all}.first(fault_count); }
    [[nodiscard]] std::span<ids::LineWaveform const> disturbed() const {
        return std::span{all}.subspan(fault_count, disturbed_count);
    }
    [[nodiscard]] std::span<ids::LineWaveform const> quiet() const {
        return std::span{all}.subspan(fault_count + disturbed_count);
    }
};

Result<Recordings> simulate_all(Options const& o, cli::Exploration const& exploration) {
    std::vector<std::pair<Situation, std::uint64_t>> wanted;
    std::array<Situation, 7> const healthy{Situation::quiet,          Situation::load_step, Situation::line_trip,
                                           Situation::generator_trip, Situation::swing,     Situation::external_3ph,
                                           Situation::external_1ph};
    for (std::int64_t k = 0; k < o.faults; ++k) {
        wanted.emplace_back(static_cast<Situation>(static_cast<int>(Situation::internal_3ph) + k % 3), 10'000 + k);
    }
    for (std::int64_t k = 0; k < 7 * o.healthy; ++k) {
        wanted.emplace_back(healthy[static_cast<std::size_t>(k % 7)], 20'000 + k);
    }
    for (std::int64_t k = 0; k < o.attacks; ++k) {
        wanted.emplace_back(Situation::quiet, 30'000 + k);
    }
    Recordings out{std::vector<ids::LineWaveform>(wanted.size()), static_cast<std::size_t>(o.faults),
                   static_cast<std::size_t>(7 * o.healthy)};
    std::vector<std::string> errors(wanted.size());
    ids::for_each_chunk(wanted.size(), o.threads, [&](std::size_t k) {
        auto run = exploration.run(wanted[k].first, static_cast<std::uint64_t>(o.seed), wanted[k].second);
        if (run) {
            out.all[k] = std::move(*run);
        } else {
            errors[k] = describe(run.error());
        }
    });
    for (std::string const& error : errors) {
        if (!error.empty()) {
            return fail(ExitCode::environment, error);
        }
    }
    return out;
}

double percent(std::uint64_t n, std::uint64_t of) {
    return ids::share_of(n, of).percent;
}

/// Of the faults, then of the runs without.
std::vector<ids::TrialOutcome> try_without_attack(GuardedRelay const& sut, Recordings const& recordings,
                                                  Options const& o) {
    std::vector<ids::TrialOutcome> outcomes(recordings.fault_count + recordings.disturbed_count);
    ids::for_each_chunk(outcomes.size(), o.threads, [&](std::size_t k) {
        outcomes[k] = run_trial(sut.design.model, sut.detector, sut.relay, recordings.all[k], nullptr,
                                static_cast<std::uint64_t>(o.seed));
    });
    return outcomes;
}

/// When the element trips on each fault; -1 where it does not see the fault.
std::vector<std::int64_t> trips_on(std::span<ids::LineWaveform const> faults,
                                   std::span<ids::TrialOutcome const> outcomes) {
    std::vector<std::int64_t> out;
    for (std::size_t k = 0; k < faults.size(); ++k) {
        out.push_back(outcomes[k].trip >= faults[k].event ? outcomes[k].trip : -1);
    }
    return out;
}

/// `unguarded`: when the element trips that no detector guards, which is what a design can be asked for.
void print_row(std::string const& design, Recordings const& recordings, std::span<ids::TrialOutcome const> outcomes,
               std::span<std::int64_t const> unguarded, double ms) {
    auto const faults = recordings.faults();
    std::vector<double> delays, added;
    std::uint64_t tripped = 0, early = 0, false_trips = 0, alarms = 0, locked = 0, possible = 0, forgery = 0;
    for (std::size_t k = 0; k < faults.size(); ++k) {
        std::int64_t const trip = outcomes[k].trip, event = faults[k].event;
        bool const right = trip >= event;
        early += trip >= 0 && trip < event ? 1U : 0U;
        if (unguarded[k] < 0) {
            continue; // the element itself does not see this fault
        }
        ++possible;
        tripped += right ? 1U : 0U;
        if (right) {
            delays.push_back(static_cast<double>(trip - event) * ms);
            added.push_back(static_cast<double>(trip - unguarded[k]) * ms);
        }
    }
    for (ids::TrialOutcome const& outcome : outcomes.subspan(faults.size())) {
        false_trips += outcome.trip >= 0 ? 1U : 0U;
        alarms += outcome.alarms > 0 ? 1U : 0U;
        forgery += outcome.alarm >= 0 ? 1U : 0U;
        locked += outcome.locked_out ? 1U : 0U;
    }
    std::size_t const disturbed = recordings.disturbed_count;
    fmt::print("| {} | {:.1f} of {} | {} | {} | {} | {:.1f} | {:.1f} ({:.1f}) | {:.1f} |\n", design,
               percent(tripped, possible), possible, percentiles(delays), percentiles(added), early,
               percent(false_trips, disturbed), percent(alarms, disturbed), percent(forgery, disturbed),
               percent(locked, disturbed));
    std::fflush(stdout);
}

/// By attack, then by run.
struct AttackOutcomes {
    std::vector<std::vector<char>> trips;
    std::vector<std::vector<double>> alarms_ms; ///< after the attack's beginning; -1: never
};

AttackOutcomes try_attacks(GuardedRelay const& sut, std::span<ids::LineWaveform const> quiet,
                           ids::TrainingConfig const& config, Options const& o) {
    ids::SimulatedParams const& grid = *config.simulated;
    double const ms = 1000 / config.rate_hz;
    std::int64_t const cycle = sut.relay.element.samples_per_cycle;
    std::int64_t const start = 18 * cycle,
                       length = static_cast<std::int64_t>(grid.duration_s * config.rate_hz) - start - cycle;
    std::size_t const kinds =
        ids::attack_catalogue(grid.nominal_peak_a, config.rate_hz, config.frequency_hz, start, length).size();
    AttackOutcomes out{{kinds, std::vector<char>(quiet.size())}, {kinds, std::vector<double>(quiet.size(), -1)}};
    ids::for_each_chunk(quiet.size(), o.threads, [&](std::size_t run) {
        auto const attacks = ids::attack_catalogue(grid.nominal_peak_a, config.rate_hz, config.frequency_hz,
                                                   start + static_cast<std::int64_t>(run * 37) % cycle, length);
        for (std::size_t a = 0; a < attacks.size(); ++a) {
            ids::TrialOutcome const outcome = run_trial(sut.design.model, sut.detector, sut.relay, quiet[run],
                                                        &attacks[a], static_cast<std::uint64_t>(o.seed) + run);
            out.trips[a][run] = outcome.trip >= 0 ? 1 : 0;
            if (outcome.alarm >= 0) {
                out.alarms_ms[a][run] = static_cast<double>(outcome.alarm - attacks[a].from.from) * ms;
            }
        }
    });
    return out;
}

std::vector<std::string> trip_cells(AttackOutcomes const& outcomes) {
    std::vector<std::string> cells;
    for (auto const& t : outcomes.trips) {
        cells.push_back(
            fmt::format("{:.0f}", percent(static_cast<std::uint64_t>(std::count(t.begin(), t.end(), 1)), t.size())));
    }
    return cells;
}

std::vector<std::string> alarm_cells(AttackOutcomes const& outcomes) {
    std::vector<std::string> cells;
    for (std::vector<double> const& by_run : outcomes.alarms_ms) {
        std::vector<double> alarmed = by_run;
        std::erase(alarmed, -1);
        std::sort(alarmed.begin(), alarmed.end());
        cells.push_back(alarmed.empty() ? "0"
                                        : fmt::format("{:.0f}, {:.1f}", percent(alarmed.size(), by_run.size()),
                                                      alarmed[alarmed.size() / 2]));
    }
    return cells;
}

/// A line for each attack. `cells`: by design, then by attack.
void print_attack_table(std::span<Design const> all_designs, std::span<ids::CataloguedAttack const> attacks,
                        std::span<std::vector<std::string> const> cells) {
    for (Design const& d : all_designs) {
        fmt::print(" {} |", d.name);
    }
    fmt::print("\n|---|");
    for (std::size_t k = 0; k < all_designs.size(); ++k) {
        fmt::print("---|");
    }
    for (std::size_t a = 0; a < attacks.size(); ++a) {
        fmt::print("\n| {} |", attacks[a].name);
        for (auto const& of_design : cells) {
            fmt::print(" {} |", of_design[a]);
        }
    }
    fmt::print("\n");
}

/// The chapter of one kind of element: every design on what is genuine, then under attack.
Result<void> print_element(relay::ElementParams::Kind kind, std::span<Design const> all_designs,
                           Recordings const& recordings, ids::TrainingConfig const& config, Options const& o) {
    double const nominal_peak_a = config.simulated->nominal_peak_a;
    relay::RelayParams const relay = relay_params(kind, config);
    fmt::print("\n## {} element, pickup {:.2f} A\n\n",
               kind == relay::ElementParams::Kind::rms ? "rms (Eq. 5-6)" : "phasor", relay.element.pickup_a);
    fmt::print("| detector | trips on faults, % | delay ms, median / p95 / max | added ms | trips before the fault "
               "| false trips, % of {} | alarms (but for noise), % | locked out, % |\n"
               "|---|---|---|---|---|---|---|---|\n",
               recordings.disturbed_count);
    std::vector<std::int64_t> unguarded;
    std::vector<std::vector<std::string>> tripped, alarmed;
    for (Design const& d : all_designs) {
        auto const detector = ids::make_detector_params(d.config, d.model, config.rate_hz, config.frequency_hz);
        if (!detector) {
            return std::unexpected{detector.error()};
        }
        GuardedRelay const sut{d, *detector, relay};
        auto const outcomes = try_without_attack(sut, recordings, o);
        if (unguarded.empty()) { // the first design is no detector
            unguarded = trips_on(recordings.faults(), outcomes);
        }
        print_row(d.name, recordings, outcomes, unguarded, 1000 / config.rate_hz);
        AttackOutcomes const attacked = try_attacks(sut, recordings.quiet(), config, o);
        tripped.push_back(trip_cells(attacked));
        alarmed.push_back(alarm_cells(attacked));
    }
    auto const attacks = ids::attack_catalogue(nominal_peak_a, config.rate_hz, config.frequency_hz, 0, 1);
    std::size_t const runs = recordings.quiet().size();
    fmt::print("\nFalse trips in % of {} runs:\n\n| attack |", runs);
    print_attack_table(all_designs, attacks, tripped);
    fmt::print("\nAlarmed, % of {} runs, and after how many ms (median):\n\n| attack |", runs);
    print_attack_table(all_designs, attacks, alarmed);
    std::fflush(stdout);
    return {};
}

int main_function(Options const& o) {
    config::Diagnostics diagnostics;
    auto config = ids::load_training_config(o.config, diagnostics);
    if (!config || !config->simulated) {
        fmt::print(stderr, "{}\n{}: it has to describe data.simulated\n", diagnostics.render(), o.config.string());
        return static_cast<int>(ExitCode::usage);
    }
    ids::SimulatedParams const& grid = *config->simulated;
    auto const exploration = cli::Exploration::create(grid, config->rate_hz);
    auto const all_designs = designs(o.models, grid.nominal_peak_a);
    if (!exploration || !all_designs) {
        return stop(!exploration ? exploration.error() : all_designs.error());
    }
    auto const recordings = simulate_all(o, *exploration);
    if (!recordings) {
        return stop(recordings.error());
    }
    fmt::print("{} internal faults, {} runs without (7 situations), {} runs for each attack; seed {}, {}\n",
               recordings->fault_count, recordings->disturbed_count, recordings->quiet().size(), o.seed,
               grid.network.filename().string());
    if (o.timings > 0) {
        Design const& d = *std::find_if(all_designs->begin(), all_designs->end(),
                                        [](Design const& design) { return design.name == "supervise, block"; });
        auto const detector = ids::make_detector_params(d.config, d.model, config->rate_hz, config->frequency_hz);
        if (!detector) {
            return stop(detector.error());
        }
        GuardedRelay const sut{d, *detector, relay_params(relay::ElementParams::Kind::phasor, *config)};
        auto const printed = print_masquerade_timings(o.timings, o.threads, sut, recordings->disturbed(), *config);
        return printed ? 0 : stop(printed.error());
    }
    for (auto const kind : {relay::ElementParams::Kind::phasor, relay::ElementParams::Kind::rms}) {
        if (auto ok = print_element(kind, *all_designs, *recordings, *config, o); !ok) {
            return stop(ok.error());
        }
    }
    return 0;
}

} // namespace
} // namespace gridspace

int main(int argc, char** argv) {
    gridspace::Options o;
    CLI::App app{"design choices of the intrusion detector"};
    app.add_option("--faults", o.faults)->check(CLI::Range(3, 100'000));
    app.add_option("--healthy", o.healthy)->check(CLI::Range(1, 100'000));
    app.add_option("--attacks", o.attacks)->check(CLI::Range(1, 100'000));
    app.add_option("--timings", o.timings, "instead: so many masquerades timed after disturbances")
        ->check(CLI::Range(0, 1'000'000));
    app.add_option("--seed", o.seed)->check(CLI::NonNegativeNumber);
    app.add_option("--threads", o.threads)->check(CLI::Range(1, 256));
    app.add_option("--config", o.config, "a training configuration with data.simulated");
    app.add_option("--models", o.models, "folder of mlp_20_10_1.json and ar_20.json");
    CLI11_PARSE(app, argc, argv);
    return gridspace::main_function(o);
}

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The table of design choices of docs/design/ids.md: how a line relay fares with each kind of detector in front of it,
// on faults, disturbances and forgeries simulated with the waveform solver.
//
//   bench_ids [--faults 120] [--healthy 20] [--attacks 100] [--seed 1] [--threads 2] [--config configs/ids/bench.yaml]
#include "ids/detector/detector_config.hpp"
#include "ids/evaluation/protection_trial.hpp"
#include "ids/forecaster/model_file.hpp"
#include "ids/scoring/interval.hpp"
#include "ids/training/chunks.hpp"
#include "launcher/ids/exploration.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace {
namespace {

using ids::Situation;

struct Options {
    std::int64_t faults{120}, healthy{20}, attacks{100}, seed{1}, timings{0};
    int threads{2};
    std::filesystem::path config{"configs/ids/bench.yaml"}, models{"configs/models"};
};

struct Design {
    std::string name;
    ids::Model model;
    ids::DetectorConfig config;
};

int stop(Error const& error) {
    fmt::print(stderr, "error: {}\n", describe(error));
    return static_cast<int>(error.code);
}

Result<std::vector<Design>> designs(Options const& o, double nominal_peak_a) {
    auto const mlp = ids::load_model(o.models / "mlp_20_10_1.json"), ar = ids::load_model(o.models / "ar_20.json");
    if (!mlp || !ar) {
        return std::unexpected{!mlp ? mlp.error() : ar.error()};
    }
    using Of = ids::ThresholdParams::Of;
    std::vector<Design> out;
    auto add = [&](std::string name, ids::Model const& model, ids::Mode mode, Of of) -> ids::DetectorConfig& {
        out.push_back({std::move(name), model, {}});
        out.back().config.mode = mode;
        out.back().config.of = of;
        out.back().config.nominal_peak_a = nominal_peak_a;
        return out.back().config;
    };
    add("no detector", *ar, ids::Mode::monitor, Of::larger_peak);
    add("paper, 20-10-1", *mlp, ids::Mode::paper, Of::nominal_peak);
    add("paper, AR(20)", *ar, ids::Mode::paper, Of::nominal_peak);
    for (std::int64_t const k : {1, 8, 19}) {
        add(fmt::format("hold-off {}", k), *ar, ids::Mode::hold_off, Of::larger_peak).hold_off_samples = k;
    }
    add("supervise, fixed 2 %", *ar, ids::Mode::supervise, Of::larger_peak).on_unconfirmed =
        ids::SupervisorParams::OnUnconfirmed::block;
    add("supervise, block", *ar, ids::Mode::supervise, Of::adaptive).on_unconfirmed =
        ids::SupervisorParams::OnUnconfirmed::block;
    add("supervise, delay", *ar, ids::Mode::supervise, Of::adaptive);
    return out;
}

relay::RelayParams relay_params(relay::ElementParams::Kind kind, double nominal_peak_a, int cycle) {
    relay::RelayParams p;
    double const nominal_rms = nominal_peak_a / std::sqrt(2.0);
    p.element.kind = kind;
    p.element.samples_per_cycle = p.element.window_samples = cycle;
    p.element.pickup_a = kind == relay::ElementParams::Kind::rms ? nominal_rms / 2 : 0.3 * nominal_rms;
    p.element.slope_percent = 30;
    return p;
}

std::string percentiles(std::vector<double> v) {
    if (v.empty()) {
        return "-";
    }
    std::sort(v.begin(), v.end());
    auto const at = [&](double p) { return v[static_cast<std::size_t>(p * static_cast<double>(v.size() - 1) + 0.5)]; };
    return fmt::format("{:.2f} / {:.2f} / {:.2f}", at(0.5), at(0.95), v.back());
}

/// A masquerade that begins so long after a disturbance that both ends see: for how long it inherits the permission.
int print_timings(Options const& o, ids::Model const& model, ids::DetectorParams const& detector,
                  relay::RelayParams const& relay, std::span<ids::LineWaveform const> disturbed, double nominal_peak_a,
                  ids::TrainingConfig const& config) {
    constexpr double kLongestMs = 20;
    std::vector<ids::LineWaveform const*> runs;
    for (ids::LineWaveform const& w : disturbed) {
        if (w.event >= 0 && w.situation != Situation::quiet && w.situation != Situation::swing) {
            runs.push_back(&w);
        }
    }
    if (runs.empty()) {
        return stop({ExitCode::usage, "there is no disturbance to wait for: --healthy", {}});
    }
    struct Trial {
        Situation situation{Situation::quiet};
        double after_ms{0};
        bool trips{false};
    };
    std::vector<Trial> trials(static_cast<std::size_t>(o.timings));
    double const ms = 1000 / config.rate_hz;
    ids::for_each_chunk(trials.size(), o.threads, [&](std::size_t k) {
        ids::LineWaveform const& w = *runs[k % runs.size()];
        auto const offset =
            static_cast<std::int64_t>(static_cast<double>(k) * kLongestMs / ms / static_cast<double>(trials.size()));
        auto const all = ids::attack_catalogue(nominal_peak_a, config.rate_hz, config.frequency_hz, w.event + offset,
                                               static_cast<std::int64_t>(w.size()));
        auto const attack =
            std::find_if(all.begin(), all.end(), [](auto const& a) { return a.name == "masquerade_5"; });
        auto const outcome = run_trial(model, detector, relay, w, &*attack, k);
        bool const without = run_trial(model, detector, relay, w, nullptr, k).trip >= 0;
        trials[k] = {w.situation, static_cast<double>(offset) * ms, outcome.trip >= 0 && !without};
    });
    fmt::print(
        "\nA masquerade of 5 p.u. at one end, {} timings up to {} ms after a disturbance; supervise, block: trips "
        "in %, by how long after it began\n\n| after | ",
        trials.size(), kLongestMs);
    std::vector<double> const edges{0, 1.25, 2.5, 5, 7.5, 10, kLongestMs};
    for (std::size_t b = 0; b + 1 < edges.size(); ++b) {
        fmt::print("{} to {} ms | ", edges[b], edges[b + 1]);
    }
    fmt::print("last that tripped |\n|---|");
    for (std::size_t b = 0; b < edges.size(); ++b) {
        fmt::print("---|");
    }
    fmt::print("\n");
    for (auto const situation : {Situation::load_step, Situation::line_trip, Situation::generator_trip,
                                 Situation::external_3ph, Situation::external_1ph}) {
        fmt::print("| {} |", ids::name_of(situation));
        double last = -1;
        for (std::size_t b = 0; b + 1 < edges.size(); ++b) {
            std::uint64_t of = 0, tripped = 0;
            for (Trial const& t : trials) {
                if (t.situation == situation && t.after_ms >= edges[b] && t.after_ms < edges[b + 1]) {
                    ++of;
                    tripped += t.trips ? 1U : 0U;
                    last = t.trips ? std::max(last, t.after_ms) : last;
                }
            }
            fmt::print(" {:.0f} of {} |", ids::share_of(tripped, of).percent, of);
        }
        fmt::print(" {} |\n", last < 0 ? std::string{"none"} : fmt::format("{:.2f} ms", last));
    }
    return 0;
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
    auto const all_designs = designs(o, grid.nominal_peak_a);
    if (!exploration || !all_designs) {
        return stop(!exploration ? exploration.error() : all_designs.error());
    }
    auto const seed = static_cast<std::uint64_t>(o.seed);
    int const cycle = static_cast<int>(std::lround(config->rate_hz / config->frequency_hz));

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
    std::vector<ids::LineWaveform> recordings(wanted.size());
    std::vector<std::string> errors(wanted.size());
    ids::for_each_chunk(wanted.size(), o.threads, [&](std::size_t k) {
        auto run = exploration->run(wanted[k].first, seed, wanted[k].second);
        if (run) {
            recordings[k] = std::move(*run);
        } else {
            errors[k] = describe(run.error());
        }
    });
    for (std::string const& error : errors) {
        if (!error.empty()) {
            return stop({ExitCode::environment, error, {}});
        }
    }
    auto const faults = std::span{recordings}.first(static_cast<std::size_t>(o.faults));
    auto const disturbed = std::span{recordings}.subspan(faults.size(), static_cast<std::size_t>(7 * o.healthy));
    auto const quiet = std::span{recordings}.subspan(faults.size() + disturbed.size());
    fmt::print("{} internal faults, {} runs without (7 situations), {} runs for each attack; seed {}, {}\n",
               faults.size(), disturbed.size(), quiet.size(), o.seed, grid.network.filename().string());

    double const ms = 1000 / config->rate_hz;
    if (o.timings > 0) {
        Design const& d = *std::find_if(all_designs->begin(), all_designs->end(),
                                        [](Design const& design) { return design.name == "supervise, block"; });
        auto const detector = ids::make_detector_params(d.config, d.model, config->rate_hz, config->frequency_hz);
        return detector ? print_timings(o, d.model, *detector,
                                        relay_params(relay::ElementParams::Kind::phasor, grid.nominal_peak_a, cycle),
                                        disturbed, grid.nominal_peak_a, *config)
                        : stop(detector.error());
    }
    for (auto const kind : {relay::ElementParams::Kind::phasor, relay::ElementParams::Kind::rms}) {
        relay::RelayParams const relay = relay_params(kind, grid.nominal_peak_a, cycle);
        fmt::print("\n## {} element, pickup {:.2f} A\n\n",
                   kind == relay::ElementParams::Kind::rms ? "rms (Eq. 5-6)" : "phasor", relay.element.pickup_a);
        fmt::print("| detector | trips on faults, % | delay ms, median / p95 / max | added ms | trips before the fault "
                   "| false trips, % of {} | alarms (but for noise), % | locked out, % |\n"
                   "|---|---|---|---|---|---|---|---|\n",
                   disturbed.size());
        std::vector<std::int64_t> unguarded(faults.size(), -1);
        std::vector<std::vector<std::string>> attack_cells, alarm_cells;
        for (Design const& d : *all_designs) {
            auto const detector = ids::make_detector_params(d.config, d.model, config->rate_hz, config->frequency_hz);
            if (!detector) {
                return stop(detector.error());
            }
            std::vector<ids::TrialOutcome> outcomes(faults.size() + disturbed.size());
            ids::for_each_chunk(outcomes.size(), o.threads, [&](std::size_t k) {
                outcomes[k] = run_trial(d.model, *detector, relay, recordings[k], nullptr, seed);
            });
            std::vector<double> delays, added;
            std::uint64_t tripped = 0, early = 0, false_trips = 0, alarms = 0, locked = 0, possible = 0, forgery = 0;
            for (std::size_t k = 0; k < faults.size(); ++k) {
                std::int64_t const trip = outcomes[k].trip, event = faults[k].event;
                bool const right = trip >= event;
                early += trip >= 0 && trip < event ? 1U : 0U;
                if (&d == all_designs->data()) {
                    unguarded[k] = right ? trip : -1;
                }
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
            for (std::size_t k = faults.size(); k < outcomes.size(); ++k) {
                false_trips += outcomes[k].trip >= 0 ? 1U : 0U;
                alarms += outcomes[k].alarms > 0 ? 1U : 0U;
                forgery += outcomes[k].alarm >= 0 ? 1U : 0U;
                locked += outcomes[k].locked_out ? 1U : 0U;
            }
            auto const share = [](std::uint64_t n, std::uint64_t of) { return ids::share_of(n, of).percent; };
            fmt::print("| {} | {:.1f} of {} | {} | {} | {} | {:.1f} | {:.1f} ({:.1f}) | {:.1f} |\n", d.name,
                       share(tripped, possible), possible, percentiles(delays), percentiles(added), early,
                       share(false_trips, disturbed.size()), share(alarms, disturbed.size()),
                       share(forgery, disturbed.size()), share(locked, disturbed.size()));
            std::fflush(stdout);

            std::int64_t const start = 18 * cycle,
                               length = static_cast<std::int64_t>(grid.duration_s * config->rate_hz) - start - cycle;
            std::size_t const kinds =
                ids::attack_catalogue(grid.nominal_peak_a, config->rate_hz, config->frequency_hz, start, length).size();
            std::vector<std::vector<char>> trips(kinds, std::vector<char>(quiet.size()));
            std::vector<std::vector<double>> alarms_ms(kinds, std::vector<double>(quiet.size(), -1));
            ids::for_each_chunk(quiet.size(), o.threads, [&](std::size_t run) {
                auto const attacks = ids::attack_catalogue(grid.nominal_peak_a, config->rate_hz, config->frequency_hz,
                                                           start + static_cast<std::int64_t>(run * 37) % cycle, length);
                for (std::size_t a = 0; a < attacks.size(); ++a) {
                    ids::TrialOutcome const outcome =
                        run_trial(d.model, *detector, relay, quiet[run], &attacks[a], seed + run);
                    trips[a][run] = outcome.trip >= 0 ? 1 : 0;
                    if (outcome.alarm >= 0) {
                        alarms_ms[a][run] = static_cast<double>(outcome.alarm - attacks[a].from.from) * ms;
                    }
                }
            });
            std::vector<std::string> cells;
            for (auto const& t : trips) {
                cells.push_back(fmt::format(
                    "{:.0f}", share(static_cast<std::uint64_t>(std::count(t.begin(), t.end(), 1)), t.size())));
            }
            attack_cells.push_back(std::move(cells));
            cells.clear();
            for (std::vector<double>& delays_ms : alarms_ms) {
                std::erase(delays_ms, -1);
                std::sort(delays_ms.begin(), delays_ms.end());
                cells.push_back(delays_ms.empty() ? "0"
                                                  : fmt::format("{:.0f}, {:.1f}", share(delays_ms.size(), quiet.size()),
                                                                delays_ms[delays_ms.size() / 2]));
            }
            alarm_cells.push_back(std::move(cells));
        }
        auto const attacks = ids::attack_catalogue(grid.nominal_peak_a, config->rate_hz, config->frequency_hz, 0, 1);
        auto const table = [&](std::vector<std::vector<std::string>> const& cells) {
            for (Design const& d : *all_designs) {
                fmt::print(" {} |", d.name);
            }
            fmt::print("\n|---|");
            for (std::size_t k = 0; k < all_designs->size(); ++k) {
                fmt::print("---|");
            }
            for (std::size_t a = 0; a < attacks.size(); ++a) {
                fmt::print("\n| {} |", attacks[a].name);
                for (auto const& of_design : cells) {
                    fmt::print(" {} |", of_design[a]);
                }
            }
            fmt::print("\n");
        };
        fmt::print("\nFalse trips in % of {} runs:\n\n| attack |", quiet.size());
        table(attack_cells);
        fmt::print("\nAlarmed, % of {} runs, and after how many ms (median):\n\n| attack |", quiet.size());
        table(alarm_cells);
        std::fflush(stdout);
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

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bench/ids/masquerade_timings.hpp"

#include "ids/evaluation/protection_trial.hpp"
#include "ids/scoring/interval.hpp"
#include "ids/training/chunks.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <string>
#include <vector>

namespace gridspace {
namespace {

/// A masquerade that began so long after a disturbance that both ends see.
struct TimedMasquerade {
    ids::Situation situation{ids::Situation::quiet};
    double after_ms{0};
    bool trips{false}; ///< where the relay would not without it
};

constexpr double kLongestMs = 20;

std::vector<TimedMasquerade> try_timings(std::int64_t timings, int threads, GuardedRelay const& sut,
                                         std::span<ids::LineWaveform const* const> runs,
                                         ids::TrainingConfig const& config) {
    std::vector<TimedMasquerade> trials(static_cast<std::size_t>(timings));
    double const ms = 1000 / config.rate_hz;
    ids::for_each_chunk(trials.size(), threads, [&](std::size_t k) {
        ids::LineWaveform const& w = *runs[k % runs.size()];
        auto const offset =
            static_cast<std::int64_t>(static_cast<double>(k) * kLongestMs / ms / static_cast<double>(trials.size()));
        auto const all = ids::attack_catalogue(config.simulated->nominal_peak_a, config.rate_hz, config.frequency_hz,
                                               w.event + offset, static_cast<std::int64_t>(w.size()));
        auto const attack =
            std::find_if(all.begin(), all.end(), [](auto const& a) { return a.name == "masquerade_5"; });
        auto const outcome = run_trial(sut.design.model, sut.detector, sut.relay, w, &*attack, k);
        bool const without = run_trial(sut.design.model, sut.detector, sut.relay, w, nullptr, k).trip >= 0;
        trials[k] = {w.situation, static_cast<double>(offset) * ms, outcome.trip >= 0 && !without};
    });
    return trials;
}

} // namespace

Result<void> print_masquerade_timings(std::int64_t timings, int threads, GuardedRelay const& sut,
                                      std::span<ids::LineWaveform const> disturbed, ids::TrainingConfig const& config) {
    std::vector<ids::LineWaveform const*> runs;
    for (ids::LineWaveform const& w : disturbed) {
        if (w.event >= 0 && w.situation != ids::Situation::quiet && w.situation != ids::Situation::swing) {
            runs.push_back(&w);
        }
    }
    if (runs.empty()) {
        return fail(ExitCode::usage, "there is no disturbance to wait for: --healthy");
    }
    std::vector<TimedMasquerade> const trials = try_timings(timings, threads, sut, runs, config);
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
    for (auto const situation : {ids::Situation::load_step, ids::Situation::line_trip, ids::Situation::generator_trip,
                                 ids::Situation::external_3ph, ids::Situation::external_1ph}) {
        fmt::print("| {} |", ids::name_of(situation));
        double last = -1;
        for (std::size_t b = 0; b + 1 < edges.size(); ++b) {
            std::uint64_t of = 0, tripped = 0;
            for (TimedMasquerade const& t : trials) {
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
    return {};
}

} // namespace gridspace

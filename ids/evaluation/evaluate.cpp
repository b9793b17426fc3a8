// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/evaluation/evaluate.hpp"

#include "ids/evaluation/attack_catalogue.hpp"
#include "ids/training/chunks.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

namespace gridspace::ids {
namespace {

/// Counts of one recording, put together in the order of recordings.
struct Tally {
    std::uint64_t samples{0};
    double squares{0}, largest{0};
    std::vector<float> errors;                             ///< percent of nominal
    std::array<std::array<std::uint64_t, 3>, 5> flagged{}; ///< threshold, part
    std::array<std::uint64_t, 3> parts{};                  ///< before, first cycle, later

    void add(Tally const& t) {
        samples += t.samples;
        squares += t.squares;
        largest = std::max(largest, t.largest);
        errors.insert(errors.end(), t.errors.begin(), t.errors.end());
        for (std::size_t k = 0; k < 3; ++k) {
            parts[k] += t.parts[k];
            for (std::size_t h = 0; h < 5; ++h) {
                flagged[h][k] += t.flagged[h][k];
            }
        }
    }
    [[nodiscard]] ForecastQuality quality() const {
        ForecastQuality q;
        q.samples = samples;
        q.max_percent = largest;
        if (!errors.empty()) {
            std::vector<float> sorted = errors;
            auto const at =
                sorted.begin() + static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(sorted.size() - 1));
            std::nth_element(sorted.begin(), at, sorted.end());
            q.p999_percent = static_cast<double>(*at);
            q.rms_percent = std::sqrt(squares / static_cast<double>(errors.size()));
        }
        for (std::size_t h = 0; h < 5; ++h) {
            q.before[h] = share_of(flagged[h][0], parts[0]);
            q.first_cycle[h] = share_of(flagged[h][1], parts[1]);
            q.later[h] = share_of(flagged[h][2], parts[2]);
        }
        return q;
    }
};

int cycle_of(LineWaveform const& w) {
    return static_cast<int>(std::lround(w.rate_hz / w.frequency_hz));
}

GuardParams guard_params(LineWaveform const& w, ThresholdParams::Of of, double percent, double nominal_peak_a) {
    GuardParams p;
    p.mode = Mode::monitor;
    p.threshold.of = of;
    p.threshold.percent = percent;
    p.threshold.nominal_peak_a = nominal_peak_a;
    p.threshold.peak_samples = cycle_of(w);
    return p;
}

Tally tally_of(Model const& model, LineWaveform const& w, EvaluationOptions const& o, double nominal_peak_a) {
    Tally out;
    int const cycle = cycle_of(w);
    for (std::vector<Abc> const* end : {&w.from, &w.to}) {
        if (end->empty()) {
            continue;
        }
        for (std::size_t h = 0; h < kThresholds.size(); ++h) {
            StreamGuard guard{model, guard_params(w, kThresholds[h], o.percent, nominal_peak_a)};
            for (std::size_t k = 0; k < end->size(); ++k) {
                StreamVerdict const& v = guard.step(static_cast<std::int64_t>(k), (*end)[k]);
                if (!v.ready) {
                    continue;
                }
                std::int64_t const since = static_cast<std::int64_t>(k) - w.event;
                std::size_t const part = w.event < 0 || since < 0 ? 0 : since < cycle ? 1 : 2;
                for (ChannelVerdict const& c : v.phases) {
                    out.flagged[h][part] += c.flagged ? 1U : 0U;
                    if (h != 0) {
                        continue;
                    }
                    ++out.samples;
                    ++out.parts[part];
                    if (part == 0) {
                        double const e = 100 * std::fabs(c.raw_a - c.forecast_a) / nominal_peak_a;
                        out.squares += e * e;
                        out.largest = std::max(out.largest, e);
                        out.errors.push_back(static_cast<float>(e));
                    }
                }
            }
        }
    }
    return out;
}

struct AttackTally {
    bool seen{false}, kirchhoff{false};
    std::int64_t delay{0};
    std::uint64_t altered{0}, flagged{0};
};

AttackTally attack(Model const& model, LineWaveform const& w, CataloguedAttack const& a, EvaluationOptions const& o,
                   double nominal_peak_a, std::uint64_t run) {
    AttackTally out;
    auto made = attacker::SampleAttack::create(a.from, o.seed + run),
         second = attacker::SampleAttack::create(a.both_ends ? a.to : a.from, o.seed + run);
    if (!made || !second) {
        return out;
    }
    StreamGuard guard{model, guard_params(w, o.attack_threshold, o.percent, nominal_peak_a)};
    RunningPeak peak{cycle_of(w)};
    for (std::int64_t k = 0; k < std::min(a.from.until, static_cast<std::int64_t>(w.size())); ++k) {
        auto const at = static_cast<std::size_t>(k);
        auto const sent = made->apply(k, w.from[at]);
        Abc const to = w.to.empty() ? w.from[at] : a.both_ends ? second->apply(k, w.to[at]).sent_a : w.to[at];
        StreamVerdict const& v = guard.step(k, sent.sent_a);
        double const base = std::max(nominal_peak_a, peak.value());
        for (std::size_t p = 0; p < 3; ++p) {
            peak.push(w.from[at][p]);
            if (k < a.from.from) {
                continue;
            }
            out.kirchhoff = out.kirchhoff || (!w.to.empty() && std::fabs(sent.sent_a[p] - to[p]) > 0.02 * base);
            if (v.phases[p].flagged && !out.seen) {
                out.seen = true;
                out.delay = k - a.from.from;
            }
            if ((sent.altered & (1U << p)) != 0) {
                ++out.altered;
                out.flagged += v.phases[p].flagged ? 1U : 0U;
            }
        }
    }
    return out;
}

/// Attacks start where the recording is quiet, at a place that differs from run to run.
std::vector<AttackDetection> detect_attacks(Model const& model, std::span<LineWaveform const> recordings,
                                            EvaluationOptions const& o, double nominal_peak_a) {
    std::vector<LineWaveform const*> quiet;
    for (LineWaveform const& w : recordings) {
        std::int64_t const room = w.event >= 0 ? w.event : static_cast<std::int64_t>(w.size());
        if (room >= 8 * cycle_of(w)) {
            quiet.push_back(&w);
        }
    }
    std::vector<AttackDetection> out;
    if (quiet.empty()) {
        return out;
    }
    auto const catalogue_of = [&](LineWaveform const& w, std::size_t run) {
        std::int64_t const cycle = cycle_of(w), room = w.event >= 0 ? w.event : static_cast<std::int64_t>(w.size());
        std::int64_t const start = 4 * cycle + static_cast<std::int64_t>(run * 37) % cycle;
        return attack_catalogue(nominal_peak_a, w.rate_hz, w.frequency_hz, start,
                                std::min<std::int64_t>(room - start, 6 * cycle));
    };
    std::size_t const kinds = catalogue_of(*quiet[0], 0).size();
    std::vector<std::vector<AttackTally>> tallies(quiet.size());
    for_each_chunk(quiet.size(), o.threads, [&](std::size_t run) {
        for (CataloguedAttack const& a : catalogue_of(*quiet[run], run)) {
            tallies[run].push_back(attack(model, *quiet[run], a, o, nominal_peak_a, run));
        }
    });
    for (std::size_t kind = 0; kind < kinds; ++kind) {
        AttackDetection d;
        d.attack = catalogue_of(*quiet[0], 0)[kind].name;
        d.runs = quiet.size();
        std::uint64_t seen = 0, kirchhoff = 0, altered = 0, flagged = 0;
        std::vector<std::int64_t> delays;
        for (auto const& run : tallies) {
            AttackTally const& t = run[kind];
            seen += t.seen ? 1U : 0U;
            kirchhoff += t.kirchhoff ? 1U : 0U;
            altered += t.altered;
            flagged += t.flagged;
            if (t.seen) {
                delays.push_back(t.delay);
            }
        }
        d.seen = share_of(seen, d.runs);
        d.kirchhoff_seen = share_of(kirchhoff, d.runs);
        d.samples = share_of(flagged, altered);
        if (!delays.empty()) {
            std::sort(delays.begin(), delays.end());
            d.median_delay_samples = static_cast<double>(delays[delays.size() / 2]);
        }
        out.push_back(d);
    }
    return out;
}

} // namespace

char const* name_of(ThresholdParams::Of of) {
    switch (of) {
    case ThresholdParams::Of::instantaneous:
        return "instantaneous";
    case ThresholdParams::Of::nominal_peak:
        return "nominal_peak";
    case ThresholdParams::Of::running_peak:
        return "running_peak";
    case ThresholdParams::Of::larger_peak:
        return "larger_peak";
    case ThresholdParams::Of::adaptive:
        return "adaptive";
    }
    return "?";
}

Evaluation evaluate(Model const& model, std::span<LineWaveform const> recordings, EvaluationOptions const& options) {
    Evaluation out;
    out.nominal_peak_a = options.nominal_peak_a;
    if (!(out.nominal_peak_a > 0)) {
        for (LineWaveform const& w : recordings) {
            for (std::size_t k = 0; k < std::min(w.size(), static_cast<std::size_t>(2 * cycle_of(w))); ++k) {
                for (double const i : w.from[k]) {
                    out.nominal_peak_a = std::max(out.nominal_peak_a, std::isfinite(i) ? std::fabs(i) : 0);
                }
            }
        }
    }
    if (!(out.nominal_peak_a > 0)) {
        out.nominal_peak_a = 1; // a dead line: everything is zero anyway
    }
    std::vector<Tally> tallies(recordings.size());
    for_each_chunk(recordings.size(), options.threads,
                   [&](std::size_t k) { tallies[k] = tally_of(model, recordings[k], options, out.nominal_peak_a); });
    Tally all;
    std::map<Situation, Tally> by_situation;
    for (std::size_t k = 0; k < recordings.size(); ++k) {
        all.add(tallies[k]);
        by_situation[recordings[k].situation].add(tallies[k]);
    }
    out.quality = all.quality();
    for (auto const& [situation, tally] : by_situation) {
        out.by_situation.emplace_back(ids::name_of(situation), tally.quality());
    }
    if (options.attacks) {
        out.attacks = detect_attacks(model, recordings, options, out.nominal_peak_a);
    }
    return out;
}

template <class Real>
double nanoseconds_per_sample(Model const& model) {
    Forecaster<Real> forecaster{model};
    std::vector<Real> history(static_cast<std::size_t>(model.window * model.channels));
    for (std::size_t k = 0; k < history.size(); ++k) {
        history[k] = static_cast<Real>(std::sin(0.0785 * static_cast<double>(k)));
    }
    std::array<Real, 3> next{};
    constexpr int kBatch = 20'000;
    std::vector<double> times;
    for (int batch = 0; batch < 9; ++batch) {
        auto const start = std::chrono::steady_clock::now();
        for (int k = 0; k < kBatch; ++k) {
            forecaster.forecast(history.data(), next.data());
            history[0] = next[0]; // each forecast depends on the one before, as in operation
        }
        std::chrono::duration<double, std::nano> const took = std::chrono::steady_clock::now() - start;
        times.push_back(took.count() / kBatch / model.channels);
    }
    std::sort(times.begin(), times.end());
    return times[times.size() / 2];
}

template double nanoseconds_per_sample<double>(Model const&);
template double nanoseconds_per_sample<float>(Model const&);

} // namespace gridspace::ids

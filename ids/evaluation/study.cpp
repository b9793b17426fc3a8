// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/evaluation/study.hpp"

#include "agents/attacker/sample_attack.hpp"
#include "ids/evaluation/evaluate.hpp"
#include "ids/training/chunks.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::ids {
namespace {

/// What training a shape costs, relative to other shapes: an iteration is dominated by the normal equations of all
/// parameters (Levenberg-Marquardt, or least squares for a linear forecaster).
double work(int window, int hidden) {
    double const parameters = hidden == 0 ? window + 1 : hidden * (window + 2) + 1;
    return parameters * parameters;
}

} // namespace

Result<std::vector<ShapeResult>> study_shapes(ShapeStudy const& study, Model const& like,
                                              std::span<LineWaveform const> training,
                                              std::span<LineWaveform const> unseen, std::uint64_t seed,
                                              std::function<void(StudyProgress const&)> const& progress) {
    std::vector<ShapeResult> out;
    double all = 0, done = 0;
    for (int const window : study.windows) {
        for (int const hidden : study.hidden) {
            all += work(window, hidden);
        }
    }
    StudyProgress at{0, study.windows.size() * study.hidden.size()};
    for (int const window : study.windows) {
        for (int const hidden : study.hidden) {
            Model shape = like;
            shape.window = window;
            shape.channels = 1;
            shape.name = fmt::format("{}-{}-1", window, hidden);
            WindowParams w;
            w.window = window;
            w.scale = like.scale;
            w.scale_a = like.scale_a;
            w.count = study.training_windows;
            TrainParams t;
            t.method = hidden == 0 ? TrainParams::Method::huber : TrainParams::Method::levenberg_marquardt;
            t.hidden = hidden;
            t.epochs = study.epochs;
            t.threads = study.threads;
            at = {out.size() + 1, at.of, window, hidden, 0, 0, at.share};
            auto const report = [&](int epoch, int epochs, double) {
                at.epoch = epoch;
                at.epochs = epochs;
                at.share = (done + work(window, hidden) * epoch / epochs) / all;
                if (progress) {
                    progress(at);
                }
                return true;
            };
            auto const model = train(draw_windows(training, w, seed), shape, t, seed, report);
            if (!model) {
                return std::unexpected{model.error()};
            }
            done += work(window, hidden);
            EvaluationOptions e;
            e.nominal_peak_a = study.nominal_peak_a;
            e.attacks = false;
            e.threads = study.threads;
            Evaluation const judged = evaluate(*model, unseen, e);
            out.push_back({window, hidden, model->parameters(), judged.quality.rms_percent, judged.quality.before[3],
                           nanoseconds_per_sample<double>(*model)});
        }
    }
    return out;
}

std::vector<FakesResult> study_fakes(Model const& model, std::span<int const> counts,
                                     std::span<LineWaveform const> quiet, double nominal_peak_a, std::uint64_t seed,
                                     int threads) {
    struct Run {
        std::uint64_t forged{0}, flagged{0};
        double error{0};
        bool locked{false}, usable{false};
    };
    std::vector<FakesResult> out;
    for (int const fakes : counts) {
        std::vector<Run> runs(quiet.size());
        for_each_chunk(quiet.size(), threads, [&](std::size_t r) {
            LineWaveform const& w = quiet[r];
            auto const cycle = static_cast<std::int64_t>(std::lround(w.rate_hz / w.frequency_hz));
            GuardParams params;
            params.mode = Mode::paper;
            params.threshold.of = ThresholdParams::Of::nominal_peak;
            params.threshold.nominal_peak_a = nominal_peak_a;
            params.threshold.peak_samples = static_cast<int>(cycle);
            StreamGuard guard{model, params};
            attacker::SampleAttackParams a;
            a.name = "fakes";
            a.channels = 1;
            a.from = 4 * cycle + static_cast<std::int64_t>(r * 37) % cycle;
            a.until = a.from + fakes;
            a.low_a = -1.1 * nominal_peak_a;
            a.high_a = 1.1 * nominal_peak_a;
            a.min_error_a = 0.06 * nominal_peak_a;
            auto attack = attacker::SampleAttack::create(a, seed + r);
            Run& run = runs[r];
            if (!attack || static_cast<std::int64_t>(w.size()) < a.until + 6 * cycle) {
                return;
            }
            run.usable = true;
            for (std::int64_t k = 0; k < a.until + 6 * cycle; ++k) {
                Abc const& truth = w.from[static_cast<std::size_t>(k)];
                auto const sent = attack->apply(k, truth);
                ChannelVerdict const v = guard.step(k, sent.sent_a).phases[0];
                if (sent.altered != 0) {
                    ++run.forged;
                    run.flagged += v.flagged ? 1U : 0U;
                    run.error = std::max(run.error, 100 * std::fabs(v.accepted_a - truth[0]) / nominal_peak_a);
                }
                if (k == a.from - 1 && guard.locked_out()) { // it was lost before the attack: says nothing about it
                    run.usable = false;
                    return;
                }
            }
            run.locked = guard.locked_out();
        });
        FakesResult f;
        f.fakes = fakes;
        std::uint64_t forged = 0, flagged = 0, locked = 0;
        std::vector<double> errors;
        for (Run const& run : runs) {
            if (!run.usable) {
                continue;
            }
            ++f.runs;
            forged += run.forged;
            flagged += run.flagged;
            locked += run.locked ? 1U : 0U;
            errors.push_back(run.error);
        }
        f.detected = share_of(flagged, forged);
        f.locked_out = share_of(locked, f.runs);
        if (!errors.empty()) {
            std::sort(errors.begin(), errors.end());
            f.error_median_percent = errors[errors.size() / 2];
            f.error_p95_percent =
                errors[(errors.size() * 95) / 100 < errors.size() ? (errors.size() * 95) / 100 : errors.size() - 1];
        }
        out.push_back(f);
    }
    return out;
}

} // namespace gridspace::ids

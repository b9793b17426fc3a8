// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/evaluation/evaluate.hpp"
#include "ids/forecaster/model_file.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/ids/recordings.hpp"

#include <cmath>
#include <expected>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

namespace gridspace::cli {
namespace {

struct IdsEvaluateArguments {
    std::filesystem::path model;
    std::vector<std::filesystem::path> data; ///< CSV, npy, or a training configuration
    double percent{2}, nominal_peak_a{0};
    std::optional<double> rate_hz, event_s;
    std::string threshold{"larger_peak"}; ///< for the attacks
    std::int64_t seed{1};
    bool attacks{true}, json{false};
};

using Json = nlohmann::ordered_json;

Json to_json(ids::Share const& s) {
    return {{"percent", s.percent},
            {"low_percent", s.low_percent},
            {"high_percent", s.high_percent},
            {"count", s.count},
            {"of", s.of}};
}

Json to_json(ids::ForecastQuality const& q) {
    Json rates = Json::object();
    for (std::size_t h = 0; h < ids::kThresholds.size(); ++h) {
        rates[ids::name_of(ids::kThresholds[h])] = {{"before", to_json(q.before[h])},
                                                    {"first_cycle", to_json(q.first_cycle[h])},
                                                    {"later", to_json(q.later[h])}};
    }
    return {{"samples", q.samples},
            {"rms_percent", q.rms_percent},
            {"p99_9_percent", q.p999_percent},
            {"max_percent", q.max_percent},
            {"false_positives", rates}};
}

std::string percent(ids::Share const& s) {
    return s.of == 0      ? "-"
           : s.count == 0 ? fmt::format("0 (< {:.2g})", s.high_percent)
                          : fmt::format("{:.3g}", s.percent);
}

void print(ids::Evaluation const& e, IdsEvaluateArguments const& a) {
    ids::ForecastQuality const& q = e.quality;
    fmt::print("\n{} phase-samples, nominal peak {:.4g} A; error before events: RMS {:.3g} %, 99.9 % "
               "below {:.3g} %, largest {:.3g} % of nominal\n",
               q.samples, e.nominal_peak_a, q.rms_percent, q.p999_percent, q.max_percent);
    fmt::print("\nfalse positives in % of phase-samples, threshold {} % of\n", a.percent);
    fmt::print("{:<16}{:>18}{:>18}{:>18}\n", "", "before events", "first cycle after", "later");
    for (std::size_t h = 0; h < ids::kThresholds.size(); ++h) {
        fmt::print("{:<16}{:>18}{:>18}{:>18}\n", ids::name_of(ids::kThresholds[h]), percent(q.before[h]),
                   percent(q.first_cycle[h]), percent(q.later[h]));
    }
    if (e.by_situation.size() > 1) {
        std::size_t const adaptive = 4;
        fmt::print("\n{:<16}{:>18}{:>18}{:>18}   (adaptive)\n", "situation", "before", "first cycle after", "later");
        for (auto const& [name, s] : e.by_situation) {
            fmt::print("{:<16}{:>18}{:>18}{:>18}\n", name, percent(s.before[adaptive]),
                       percent(s.first_cycle[adaptive]), percent(s.later[adaptive]));
        }
    }
    if (e.attacks.empty()) {
        fmt::print("{}",
                   a.attacks ? "\nno recording has eight quiet cycles at its start: no attacks were tried\n" : "");
        return;
    }
    fmt::print("\n{:<22}{:>6}{:>14}{:>16}{:>16}{:>16}   (threshold {})\n", "attack", "runs", "detected, %",
               "delay, samples", "of samples, %", "both ends, %", a.threshold);
    for (ids::AttackDetection const& d : e.attacks) {
        fmt::print("{:<22}{:>6}{:>14.4g}{:>16}{:>16.3g}{:>16.4g}\n", d.attack, d.runs, d.seen.percent,
                   d.median_delay_samples < 0 ? "-" : fmt::format("{}", d.median_delay_samples), d.samples.percent,
                   d.kirchhoff_seen.percent);
    }
    fmt::print(
        "\n\"both ends\": runs in which the two ends of the line differed by more than 2 %, without any forecast\n");
}

/// The exit code where something is wrong, which has been printed.
std::expected<std::vector<ids::LineWaveform>, int> read_data(IdsEvaluateArguments const& a, ids::Model const& model) {
    std::vector<ids::LineWaveform> recordings;
    for (std::filesystem::path const& file : a.data) {
        if (file.extension() == ".yaml" || file.extension() == ".yml") {
            config::Diagnostics diagnostics;
            auto const config = ids::load_training_config(file, diagnostics);
            if (!config) {
                fmt::print(stderr, "{}\n", diagnostics.render());
                return std::unexpected{static_cast<int>(ExitCode::usage)};
            }
            auto made = all_recordings(*config, static_cast<std::uint64_t>(a.seed), true);
            if (!made) {
                return std::unexpected{print_error(made.error())};
            }
            std::move(made->begin(), made->end(), std::back_inserter(recordings));
            continue;
        }
        auto read = ids::read_recording(file, {a.rate_hz, model.frequency_hz, a.event_s});
        if (!read) {
            return std::unexpected{print_error(read.error())};
        }
        recordings.push_back(std::move(*read));
    }
    for (ids::LineWaveform const& w : recordings) {
        if (std::abs(w.rate_hz - model.rate_hz) > 1e-6 * w.rate_hz) {
            return std::unexpected{print_error({ExitCode::usage,
                                                fmt::format("{}: {} samples a second; the model '{}' was made for {}",
                                                            w.name, w.rate_hz, model.name, model.rate_hz),
                                                "resample the recording, or train a model for its rate"})};
        }
    }
    return recordings;
}

/// By what was evaluated: all, each situation, each attack.
Json to_json(ids::Evaluation const& e, std::string const& attack_threshold) {
    Json situations = Json::object(), attacks = Json::array();
    for (auto const& [name, q] : e.by_situation) {
        situations[name] = to_json(q);
    }
    for (ids::AttackDetection const& d : e.attacks) {
        attacks.push_back(
            {{"attack", d.attack},
             {"runs", d.runs},
             {"detected", to_json(d.seen)},
             {"samples", to_json(d.samples)},
             {"kirchhoff", to_json(d.kirchhoff_seen)},
             {"median_delay_samples", d.median_delay_samples < 0 ? Json{} : Json(d.median_delay_samples)}});
    }
    return {{"all", to_json(e.quality)},
            {"situations", situations},
            {"attack_threshold", attack_threshold},
            {"attacks", attacks}};
}

int ids_evaluate(IdsEvaluateArguments const& a) {
    auto const model = ids::load_model(a.model);
    if (!model) {
        return print_error(model.error());
    }
    auto const recordings = read_data(a, *model);
    if (!recordings) {
        return recordings.error();
    }
    ids::EvaluationOptions options;
    options.percent = a.percent;
    options.nominal_peak_a = a.nominal_peak_a;
    options.attacks = a.attacks;
    options.seed = static_cast<std::uint64_t>(a.seed);
    for (auto const of : ids::kThresholds) {
        options.attack_threshold = a.threshold == ids::name_of(of) ? of : options.attack_threshold;
    }
    ids::Evaluation const e = evaluate(*model, *recordings, options);
    double const ns = ids::nanoseconds_per_sample<double>(*model),
                 ns_float = ids::nanoseconds_per_sample<float>(*model);
    if (!a.json) {
        fmt::print(
            "{} ({}, {} parameters, {:.0f} ns a phase-sample here, {:.0f} ns in single precision), {} recordings\n",
            model->name, model->kind, model->parameters(), ns, ns_float, recordings->size());
        print(e, a);
        return 0;
    }
    Json out{{"model", a.model.string()},
             {"name", model->name},
             {"sha256", model_hash(*model)},
             {"recordings", recordings->size()},
             {"threshold_percent", a.percent},
             {"nominal_peak_a", e.nominal_peak_a},
             {"ns_per_sample", ns},
             {"ns_per_sample_float", ns_float}};
    out.update(to_json(e, a.threshold));
    fmt::print("{}\n", out.dump(2));
    return 0;
}

} // namespace

void add_ids_evaluate(Command ids, Action& action) {
    auto const a = std::make_shared<IdsEvaluateArguments>();
    Command verb =
        ids.add_subcommand("evaluate", "judge a forecaster: false positives by situation, error, detection by attack");
    verb.add_option("MODEL", a->model, "model file (JSON)").required();
    verb.add_option("DATA", a->data, "recordings (CSV, npy), or a training configuration for unseen ones of its kind")
        .required();
    verb.add_option("--percent", a->percent, "threshold").check(positive());
    verb.add_option("--nominal-peak-a", a->nominal_peak_a,
                    "crest of the nominal current (default: the largest of the first two cycles)")
        .check(positive());
    verb.add_option("--rate-hz", a->rate_hz, "samples a second, for npy").check(positive());
    verb.add_option("--event-s", a->event_s, "when something happens in the recordings").check(not_negative());
    verb.add_option("--threshold", a->threshold, "what the threshold of the attack table is relative to")
        .check(one_of({"instantaneous", "nominal_peak", "running_peak", "larger_peak", "adaptive"}));
    verb.add_option("--seed", a->seed, "of unseen recordings and attacks").check(not_negative());
    verb.add_flag("!--no-attacks", a->attacks, "only the false positives");
    verb.add_flag("--json", a->json, "as JSON");
    verb.callback([a, &action] { action = [a] { return ids_evaluate(*a); }; });
}

} // namespace gridspace::cli

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// `gridspace ids study`: the published choice of 20 inputs and 10 neurons again, and how many fakes in a row the
// published loop bears.
#include "common/text.hpp"
#include "ids/evaluation/study.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/progress_line.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/ids/recordings.hpp"
#include "launcher/ids/study_tables.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <memory>

namespace gridspace::cli {
namespace {

struct IdsStudyArguments {
    std::filesystem::path config, out{"ids_study"};
    std::vector<int> windows{5, 10, 20, 40}, hidden{5, 10, 20};
    bool json{false};
};

/// Recordings in closed form, when no configuration names others: noise up to 0.5 % as in the published field data.
ids::TrainingConfig closed_form() {
    ids::TrainingConfig config;
    config.synthetic_recordings = 160;
    return config;
}

Result<ids::Model> trained(ids::TrainingConfig const& config, ids::ShapeStudy const& study, int window, int hidden,
                           std::span<ids::LineWaveform const> recordings) {
    ids::Model like = blank_model(config);
    like.window = window;
    like.channels = 1;
    ids::WindowParams w;
    w.window = window;
    w.scale = like.scale;
    w.scale_a = like.scale_a;
    w.count = study.training_windows;
    ids::TrainParams t;
    t.method = hidden == 0 ? ids::TrainParams::Method::huber : ids::TrainParams::Method::levenberg_marquardt;
    t.hidden = hidden;
    t.epochs = study.epochs;
    t.threads = study.threads;
    auto const seed = static_cast<std::uint64_t>(config.seed);
    return train(draw_windows(recordings, w, seed), like, t, seed);
}

/// Recordings in which nothing happens but the forgery: 200 in closed form, or those that the configuration has.
std::vector<ids::LineWaveform> quiet_recordings(ids::TrainingConfig const& config, std::uint64_t seed,
                                                std::span<ids::LineWaveform const> unseen) {
    std::vector<ids::LineWaveform> out;
    if (config.synthetic_recordings > 0) {
        for (std::uint64_t number = 0; number < 200; ++number) {
            out.push_back(synthesise(config.synthetic, ids::Situation::quiet, seed, 2'000'000 + number));
        }
        return out;
    }
    for (ids::LineWaveform const& r : unseen) {
        if (r.event < 0 && r.situation == ids::Situation::quiet) {
            out.push_back(r);
        }
    }
    return out;
}

/// The published shape, or the largest that was asked for.
int usual(std::vector<int> const& values, int published) {
    return std::find(values.begin(), values.end(), published) != values.end()
               ? published
               : *std::max_element(values.begin(), values.end());
}

int ids_study(IdsStudyArguments const& a) {
    config::Diagnostics diagnostics;
    auto const config = a.config.empty() ? closed_form() : ids::load_training_config(a.config, diagnostics);
    if (!config) {
        fmt::print(stderr, "{}\n", diagnostics.render());
        return static_cast<int>(ExitCode::usage);
    }
    auto const seed = static_cast<std::uint64_t>(config->seed);
    auto const training = all_recordings(*config, seed, false), unseen = all_recordings(*config, seed, true);
    if (!training || !unseen) {
        return print_error(!training ? training.error() : unseen.error());
    }
    ids::ShapeStudy study;
    study.windows = a.windows;
    study.hidden = a.hidden;
    if (std::find(study.hidden.begin(), study.hidden.end(), 0) == study.hidden.end()) {
        // A linear forecaster of the same window is what a network has to beat.
        study.hidden.insert(study.hidden.begin(), 0);
    }
    study.threads = config->training.threads;
    study.nominal_peak_a = config->simulated ? config->simulated->nominal_peak_a : config->synthetic.nominal_peak_a;

    ProgressLine shown{a.json};
    auto const start = std::chrono::steady_clock::now();
    auto shapes =
        study_shapes(study, blank_model(*config), *training, *unseen, seed, [&](ids::StudyProgress const& at) {
            double const took = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            shown.show(fmt::format("shape {} of {}, {} inputs and {} neurons, epoch {} of {}: about {} left", at.shape,
                                   at.of, at.window, at.hidden, at.epoch, at.epochs,
                                   human_duration(took / at.share * (1 - at.share))),
                       at.shape == at.of && at.epoch == at.epochs);
        });
    if (!shapes) {
        return print_error(shapes.error());
    }
    int const window = usual(a.windows, 20), hidden = std::max(usual(study.hidden, 10), 1);
    auto const network = trained(*config, study, window, hidden, *training);
    auto const linear = trained(*config, study, window, 0, *training);
    if (!network || !linear) {
        return print_error(!network ? network.error() : linear.error());
    }
    std::vector<ids::LineWaveform> const quiet = quiet_recordings(*config, seed, *unseen);
    static constexpr std::array<int, 8> kCounts{1, 2, 5, 10, 20, 40, 60, 80};
    auto const under_fakes = [&](ids::Model const& model) {
        return study_fakes(model, kCounts, quiet, study.nominal_peak_a, seed, study.threads);
    };
    StudyResults const results{std::move(*shapes), fmt::format("{}-{}-1", window, hidden), under_fakes(*network),
                               under_fakes(*linear)};
    if (auto const written = write_study(results, a.out); !written) {
        return print_error(written.error());
    }
    if (a.json) {
        fmt::print("{}\n", study_json(results, a.out));
    } else {
        fmt::print("{}\nwritten: shapes.csv, shapes.svg, fakes.csv, fakes.svg in {}\n", study_text(results),
                   a.out.string());
    }
    return 0;
}

} // namespace

void add_ids_study(Command ids, Action& action) {
    auto const a = std::make_shared<IdsStudyArguments>();
    Command verb = ids.add_subcommand(
        "study", "window and neurons against error and time; fakes in a row against the published loop");
    verb.add_option("CONFIG", a->config,
                    "training configuration (YAML): its data are used (default: closed-form recordings)");
    verb.add_option("--windows", a->windows, "window lengths").delimiter(',').check(in_range(1, 4096));
    verb.add_option("--hidden", a->hidden, "neurons; a linear forecaster is always tried too")
        .delimiter(',')
        .check(in_range(0, 1000));
    verb.add_option("--out", a->out, "folder for tables and figures");
    verb.add_flag("--json", a->json, "as JSON");
    verb.callback([a, &action] { action = [a] { return ids_study(*a); }; });
}

} // namespace gridspace::cli

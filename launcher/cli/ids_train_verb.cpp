// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "common/time.hpp"
#include "common/version.hpp"
#include "ids/forecaster/model_file.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/progress_line.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/ids/recordings.hpp"

#include <chrono>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

namespace gridspace::cli {
namespace {

struct IdsTrainArguments {
    std::filesystem::path config, output; ///< output: instead of the configuration's
    std::optional<std::int64_t> seed;
    bool json{false}, quiet{false};
};

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

char const* word(ids::TrainParams::Method method) {
    switch (method) {
    case ids::TrainParams::Method::least_squares:
        return "least_squares";
    case ids::TrainParams::Method::huber:
        return "huber";
    case ids::TrainParams::Method::back_propagation:
        return "back_propagation";
    case ids::TrainParams::Method::levenberg_marquardt:
        return "levenberg_marquardt";
    }
    return "?";
}

/// What came of it.
struct Training {
    std::filesystem::path output;
    std::size_t recordings{0}, windows{0};
    double loss_rms{0};               ///< of the window's scale, as the next
    std::optional<double> unseen_rms; ///< nothing: it has learnt from files only
    double wall_s{0};
};

void print(Training const& t, ids::Model const& model, bool as_json) {
    if (as_json) {
        fmt::print("{}\n", Json{{"model", t.output.string()},
                                {"sha256", model_hash(model)},
                                {"parameters", model.parameters()},
                                {"recordings", t.recordings},
                                {"windows", t.windows},
                                {"loss_rms_scaled", t.loss_rms},
                                {"unseen_rms_scaled", t.unseen_rms ? Json(*t.unseen_rms) : Json()},
                                {"wall_s", t.wall_s}}
                               .dump(2));
    } else {
        fmt::print("{}: {} parameters, loss {:.6f} on the training windows, {} (of the window's scale), {:.1f} s\n",
                   t.output.string(), model.parameters(), t.loss_rms,
                   t.unseen_rms ? fmt::format("RMS error {:.6f} on unseen ones", *t.unseen_rms) : "no unseen ones",
                   t.wall_s);
    }
}

/// On recordings that it was not trained with.
std::optional<double> rms_on_unseen(ids::Model const& model, ids::TrainingConfig const& config,
                                    ids::WindowParams window, std::uint64_t seed) {
    auto const unseen = all_recordings(config, seed, true);
    if (!unseen) {
        fmt::print(stderr, "note: {}\n", unseen.error().message);
        return std::nullopt;
    }
    window.count = std::min<std::size_t>(window.count, 50'000);
    return rms_error(model, draw_windows(*unseen, window, seed + 1));
}

int ids_train(IdsTrainArguments const& arguments) {
    config::Diagnostics diagnostics;
    auto config = ids::load_training_config(arguments.config, diagnostics);
    if (!config) {
        fmt::print(stderr, "{}\n", diagnostics.render());
        return static_cast<int>(ExitCode::usage);
    }
    config->seed = arguments.seed.value_or(config->seed);
    auto const seed = static_cast<std::uint64_t>(config->seed);
    std::filesystem::path const output = arguments.output.empty() ? config->output : arguments.output;
    ProgressLine shown{arguments.quiet || arguments.json};
    auto const start = Clock::now();
    auto const recordings = all_recordings(*config, seed, false, [&](std::size_t done, std::size_t of) {
        shown.show(fmt::format("simulated {} of {} runs", done, of), done == of);
    });
    if (!recordings) {
        return print_error(recordings.error());
    }
    ids::WindowParams window{static_cast<int>(config->window),
                             static_cast<int>(config->channels),
                             config->scale,
                             config->scale_a,
                             static_cast<std::size_t>(config->windows),
                             config->event_share};
    ids::Windows const data = draw_windows(*recordings, window, seed);
    shown.show(
        fmt::format("{} recordings, {} windows, {}", recordings->size(), data.count(), word(config->training.method)),
        true);
    auto const training_start = Clock::now();
    double last_rms = 0;
    auto model = train(data, blank_model(*config), config->training, seed, [&](int epoch, int of, double rms) {
        last_rms = rms;
        double const took = seconds_since(training_start);
        shown.show(fmt::format("epoch {} of {}: loss {:.6f}, about {} left", epoch, of, rms,
                               human_duration(took / epoch * (of - epoch))),
                   epoch == of);
        return true;
    });
    if (!model) {
        return print_error(model.error());
    }
    auto const unseen_rms = rms_on_unseen(*model, *config, window, seed);
    model->provenance = {{"trained_by", std::string{"gridspace "} + std::string{gridspace::version().version}},
                         {"configuration", arguments.config.filename().string()},
                         {"seed", std::to_string(seed)},
                         {"method", word(config->training.method)},
                         {"recordings", std::to_string(recordings->size())},
                         {"windows", std::to_string(data.count())},
                         {"loss_rms_scaled", shortest(last_rms)}};
    if (auto const saved = save_model(*model, output); !saved) {
        return print_error(saved.error());
    }
    Training const done{output, recordings->size(), data.count(), last_rms, unseen_rms, seconds_since(start)};
    print(done, *model, arguments.json);
    return 0;
}

} // namespace

void add_ids_train(Command ids, Action& action) {
    auto const a = std::make_shared<IdsTrainArguments>();
    Command verb = ids.add_subcommand("train", "train a forecaster");
    verb.add_option("CONFIG", a->config, "training configuration (YAML)").required();
    verb.add_option("--out", a->output, "model file instead of the configuration's");
    verb.add_option("--seed", a->seed, "seed instead of the configuration's").check(not_negative());
    verb.add_flag("--json", a->json, "the result as JSON");
    verb.add_flag("--quiet", a->quiet, "no progress");
    verb.callback([a, &action] { action = [a] { return ids_train(*a); }; });
}

} // namespace gridspace::cli

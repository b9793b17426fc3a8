// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// `gridspace ids study`: the published choice of 20 inputs and 10 neurons again, and how many fakes in a row the
// published loop bears.
#include "ids/evaluation/study.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/ids/ids_verbs.hpp"
#include "launcher/ids/recordings.hpp"
#include "launcher/ids/scatter.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>

namespace gridspace::cli {
namespace {

using Json = nlohmann::ordered_json;

Result<void> write(std::filesystem::path const& file, std::string const& text) {
    std::ofstream stream{file, std::ios::trunc};
    stream << text;
    stream.flush();
    return stream ? Result<void>{} : fail(ExitCode::environment, fmt::format("{}: cannot be written", file.string()));
}

} // namespace

int ids_study(IdsStudyArguments const& a) {
    config::Diagnostics diagnostics;
    auto const config = ids::load_training_config(a.config, diagnostics);
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
        study.hidden.insert(study.hidden.begin(),
                            0); // a linear forecaster of the same window is what a network has to beat
    }
    study.threads = config->training.threads;
    study.nominal_peak_a = config->simulated ? config->simulated->nominal_peak_a : config->synthetic.nominal_peak_a;
    auto const shapes =
        study_shapes(study, blank_model(*config), *training, *unseen, seed, [&](std::size_t done, std::size_t of) {
            if (!a.json) {
                fmt::print(stderr, "trained {} of {} shapes\n", done, of);
            }
        });
    if (!shapes) {
        return print_error(shapes.error());
    }
    // The published shape, or the largest that was asked for, under fakes in a row.
    ids::Model like = blank_model(*config);
    like.window = std::find(a.windows.begin(), a.windows.end(), 20) != a.windows.end()
                      ? 20
                      : *std::max_element(a.windows.begin(), a.windows.end());
    like.channels = 1;
    ids::TrainParams t;
    t.method = ids::TrainParams::Method::levenberg_marquardt;
    t.hidden = 10;
    t.epochs = study.epochs;
    t.threads = study.threads;
    ids::WindowParams w;
    w.window = like.window;
    w.scale = like.scale;
    w.scale_a = like.scale_a;
    w.count = study.training_windows;
    auto const network = train(draw_windows(*training, w, seed), like, t, seed);
    t.method = ids::TrainParams::Method::huber;
    t.hidden = 0;
    auto const linear = train(draw_windows(*training, w, seed), like, t, seed);
    if (!network || !linear) {
        return print_error(!network ? network.error() : linear.error());
    }
    std::vector<ids::LineWaveform> quiet;
    for (ids::LineWaveform const& r : *unseen) {
        if (r.event < 0 && r.situation == ids::Situation::quiet) {
            quiet.push_back(r);
        }
    }
    std::array<int, 8> const counts{1, 2, 5, 10, 20, 40, 60, 80};
    auto const network_fakes = study_fakes(*network, counts, quiet, study.nominal_peak_a, seed, study.threads);
    auto const linear_fakes = study_fakes(*linear, counts, quiet, study.nominal_peak_a, seed, study.threads);

    Scatter cost{"Forecasters: error against time",
                 "ns a phase-sample",
                 "RMS error before events, % of nominal",
                 true,
                 false,
                 {},
                 false};
    Scatter runs{"The published loop on its own forecasts",
                 "fakes in a row",
                 "largest error, median, % of nominal",
                 true,
                 false,
                 {},
                 true};
    std::string shapes_csv = "window,hidden,parameters,rms_percent,false_positive_percent,nanoseconds\n";
    std::string fakes_csv =
        "forecaster,fakes,runs,detected_percent,error_median_percent,error_p95_percent,locked_out_percent\n";
    Json shapes_json = Json::array(), fakes_json = Json::array();
    for (ids::ShapeResult const& s : *shapes) {
        std::string const label =
            s.hidden == 0 ? fmt::format("AR({})", s.window) : fmt::format("{}-{}-1", s.window, s.hidden);
        cost.points.push_back({s.nanoseconds, s.rms_percent, label, s.hidden == 0 ? 0 : 1});
        shapes_csv += fmt::format("{},{},{},{:.6g},{:.6g},{:.4g}\n", s.window, s.hidden, s.parameters, s.rms_percent,
                                  s.false_positive.percent, s.nanoseconds);
        shapes_json.push_back({{"window", s.window},
                               {"hidden", s.hidden},
                               {"parameters", s.parameters},
                               {"rms_percent", s.rms_percent},
                               {"false_positive_percent", s.false_positive.percent},
                               {"nanoseconds", s.nanoseconds}});
    }
    for (auto const& [name, results, group] :
         {std::tuple{"network", &network_fakes, 1}, {"linear", &linear_fakes, 0}}) {
        for (ids::FakesResult const& f : *results) {
            runs.points.push_back(
                {static_cast<double>(f.fakes), f.error_median_percent, f.fakes == counts.back() ? name : "", group});
            fakes_csv +=
                fmt::format("{},{},{},{:.4g},{:.4g},{:.4g},{:.4g}\n", name, f.fakes, f.runs, f.detected.percent,
                            f.error_median_percent, f.error_p95_percent, f.locked_out.percent);
            fakes_json.push_back({{"forecaster", name},
                                  {"fakes", f.fakes},
                                  {"runs", f.runs},
                                  {"detected_percent", f.detected.percent},
                                  {"error_median_percent", f.error_median_percent},
                                  {"error_p95_percent", f.error_p95_percent},
                                  {"locked_out_percent", f.locked_out.percent}});
        }
    }
    std::error_code error;
    std::filesystem::create_directories(a.out, error);
    for (auto const& [file, text] : {std::pair{"shapes.csv", shapes_csv},
                                     {"shapes.svg", to_svg(cost)},
                                     {"fakes.csv", fakes_csv},
                                     {"fakes.svg", to_svg(runs)}}) {
        if (auto const ok = write(a.out / file, text); !ok) {
            return print_error(ok.error());
        }
    }
    if (a.json) {
        fmt::print("{}\n", Json{{"shapes", shapes_json}, {"fakes", fakes_json}, {"folder", a.out.string()}}.dump(2));
        return 0;
    }
    fmt::print("{:>8}{:>8}{:>12}{:>16}{:>20}{:>10}\n", "window", "hidden", "parameters", "RMS error, %",
               "false positives, %", "ns");
    for (ids::ShapeResult const& s : *shapes) {
        fmt::print("{:>8}{:>8}{:>12}{:>16.3f}{:>20.4f}{:>10.0f}\n", s.window, s.hidden, s.parameters, s.rms_percent,
                   s.false_positive.percent, s.nanoseconds);
    }
    fmt::print(
        "\nThe published loop (reject, replace, feed back), one phase, {} runs that were in order before the attack:\n",
        network_fakes.empty() ? 0 : network_fakes[0].runs);
    fmt::print("{:<10}{:>8}{:>14}{:>26}{:>16}\n", "", "fakes", "detected, %", "error median / p95, %", "locked out, %");
    for (auto const& [name, results] : {std::pair{"network", &network_fakes}, {"linear", &linear_fakes}}) {
        for (ids::FakesResult const& f : *results) {
            fmt::print("{:<10}{:>8}{:>14.1f}{:>26}{:>16.1f}\n", name, f.fakes, f.detected.percent,
                       fmt::format("{:.2f} / {:.2f}", f.error_median_percent, f.error_p95_percent),
                       f.locked_out.percent);
        }
    }
    fmt::print("\nwritten: shapes.csv, shapes.svg, fakes.csv, fakes.svg in {}\n", a.out.string());
    return 0;
}

} // namespace gridspace::cli

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/study_tables.hpp"

#include "launcher/ids/scatter.hpp"

#include <array>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

namespace gridspace::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string label_of(ids::ShapeResult const& s) {
    return s.hidden == 0 ? fmt::format("AR({})", s.window) : fmt::format("{}-{}-1", s.window, s.hidden);
}

/// The two forecasters under fakes, and the group (colour) of each in the figures.
struct Series {
    char const* name;
    std::vector<ids::FakesResult> const& results;
    int group;
};
std::array<Series, 2> fakes_of(StudyResults const& r) {
    return {{{"network", r.network_fakes, 1}, {"linear", r.linear_fakes, 0}}};
}

Result<void> write(std::filesystem::path const& file, std::string const& text) {
    std::ofstream stream{file, std::ios::trunc};
    stream << text;
    stream.flush();
    return stream ? Result<void>{} : fail(ExitCode::environment, fmt::format("{}: cannot be written", file.string()));
}

std::string shapes_svg(StudyResults const& r) {
    Scatter plot{"Forecasters: error against time",
                 "ns a phase-sample",
                 "RMS error before events, % of nominal",
                 true,
                 false,
                 {},
                 false};
    for (ids::ShapeResult const& s : r.shapes) {
        plot.points.push_back({s.nanoseconds, s.rms_percent, label_of(s), s.hidden == 0 ? 0 : 1});
    }
    return to_svg(plot);
}

std::string fakes_svg(StudyResults const& r) {
    Scatter plot{"The published loop on its own forecasts",
                 "fakes in a row",
                 "largest error, median, % of nominal",
                 true,
                 false,
                 {},
                 true};
    for (Series const& series : fakes_of(r)) {
        for (ids::FakesResult const& f : series.results) {
            bool const last = &f == &series.results.back();
            plot.points.push_back(
                {static_cast<double>(f.fakes), f.error_median_percent, last ? series.name : "", series.group});
        }
    }
    return to_svg(plot);
}

std::string shapes_csv(StudyResults const& r) {
    std::string out = "window,hidden,parameters,rms_percent,false_positive_percent,nanoseconds\n";
    for (ids::ShapeResult const& s : r.shapes) {
        out += fmt::format("{},{},{},{:.6g},{:.6g},{:.4g}\n", s.window, s.hidden, s.parameters, s.rms_percent,
                           s.false_positive.percent, s.nanoseconds);
    }
    return out;
}

std::string fakes_csv(StudyResults const& r) {
    std::string out =
        "forecaster,fakes,runs,detected_percent,error_median_percent,error_p95_percent,locked_out_percent\n";
    for (Series const& series : fakes_of(r)) {
        for (ids::FakesResult const& f : series.results) {
            out += fmt::format("{},{},{},{:.4g},{:.4g},{:.4g},{:.4g}\n", series.name, f.fakes, f.runs,
                               f.detected.percent, f.error_median_percent, f.error_p95_percent, f.locked_out.percent);
        }
    }
    return out;
}

} // namespace

std::string study_text(StudyResults const& r) {
    std::string out =
        fmt::format("{:>10}{:>12}{:>16}{:>20}{:>10}\n", "", "parameters", "RMS error, %", "false positives, %", "ns");
    for (ids::ShapeResult const& s : r.shapes) {
        out += fmt::format("{:>10}{:>12}{:>16.3f}{:>20.4f}{:>10.0f}\n", label_of(s), s.parameters, s.rms_percent,
                           s.false_positive.percent, s.nanoseconds);
    }
    out +=
        fmt::format("\nThe published loop (reject, replace, feed back) on one phase, with the network {} and with a "
                    "linear forecaster of the same window,\nin {} and {} runs that were in order before the attack:\n",
                    r.network, r.network_fakes.empty() ? 0 : r.network_fakes[0].runs,
                    r.linear_fakes.empty() ? 0 : r.linear_fakes[0].runs);
    out += fmt::format("{:<10}{:>8}{:>14}{:>26}{:>16}\n", "", "fakes", "detected, %", "error median / p95, %",
                       "locked out, %");
    for (Series const& series : fakes_of(r)) {
        for (ids::FakesResult const& f : series.results) {
            out += fmt::format("{:<10}{:>8}{:>14.1f}{:>26}{:>16.1f}\n", series.name, f.fakes, f.detected.percent,
                               fmt::format("{:.2f} / {:.2f}", f.error_median_percent, f.error_p95_percent),
                               f.locked_out.percent);
        }
    }
    return out;
}

std::string study_json(StudyResults const& r, std::filesystem::path const& folder) {
    Json shapes = Json::array(), fakes = Json::array();
    for (ids::ShapeResult const& s : r.shapes) {
        shapes.push_back({{"window", s.window},
                          {"hidden", s.hidden},
                          {"parameters", s.parameters},
                          {"rms_percent", s.rms_percent},
                          {"false_positive_percent", s.false_positive.percent},
                          {"nanoseconds", s.nanoseconds}});
    }
    for (Series const& series : fakes_of(r)) {
        for (ids::FakesResult const& f : series.results) {
            fakes.push_back({{"forecaster", series.name},
                             {"fakes", f.fakes},
                             {"runs", f.runs},
                             {"detected_percent", f.detected.percent},
                             {"error_median_percent", f.error_median_percent},
                             {"error_p95_percent", f.error_p95_percent},
                             {"locked_out_percent", f.locked_out.percent}});
        }
    }
    return Json{{"shapes", shapes}, {"network", r.network}, {"fakes", fakes}, {"folder", folder.string()}}.dump(2);
}

Result<void> write_study(StudyResults const& r, std::filesystem::path const& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error); // what went wrong shows at the first file
    for (auto const& [file, text] : {std::pair{"shapes.csv", shapes_csv(r)},
                                     {"shapes.svg", shapes_svg(r)},
                                     {"fakes.csv", fakes_csv(r)},
                                     {"fakes.svg", fakes_svg(r)}}) {
        if (auto const ok = write(folder / file, text); !ok) {
            return ok;
        }
    }
    return {};
}

} // namespace gridspace::cli

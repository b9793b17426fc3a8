// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/figures.hpp"

#include "common/config/yaml.hpp"
#include "common/text.hpp"
#include "launcher/report/detector_figures.hpp"
#include "launcher/report/impedance_figure.hpp"
#include "launcher/report/report_assets.hpp"
#include "launcher/report/restraint_figure.hpp"
#include "launcher/report/series.hpp"
#include "launcher/report/stream_figures.hpp"
#include "launcher/report/time_current_figure.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace gridspace::launcher {
namespace {

using config::Node;
using Kind = FigureSettings::Kind;

/// What an axis spans at least that begins there.
double least_width(double begin) {
    return std::max(1e-9, 1e-9 * std::abs(begin));
}

/// Bounds of expectations about the least or greatest value of what a figure draws.
void add_expected(Figure& f, FigureSettings const& settings, Results const& r) {
    for (ExpectationResult const& e : r.expectations) {
        bool const drawn = std::any_of(settings.series.begin(), settings.series.end(), [&](auto const& s) {
            return s.expression && !s.right_axis && s.rms_over_s <= 0 && s.expression->text() == e.of;
        });
        if (!drawn || (e.verb != "min_of" && e.verb != "max_of")) {
            continue;
        }
        for (auto const& bound : {e.band.low, e.band.high}) {
            bool const there = std::any_of(f.lines.begin(), f.lines.end(),
                                           [&](auto const& line) { return bound && line.value == *bound; });
            if (bound && !there) {
                f.lines.push_back({"expected: " + shortest(*bound), *bound});
            }
        }
    }
}

double end_of(Drawn const& run) {
    return run.results.outcome.simulated_s > 0 ? run.results.outcome.simulated_s : 1;
}

std::vector<Figure::Series> all_series(FigureSettings const& settings, Drawn const& run, std::string& note) {
    std::vector<Figure::Series> out;
    std::vector<std::string> not_measurable;
    Colours colours;
    for (FigureSettings::Series const& s : settings.series) {
        auto more = drawn_series(s, run.results.signals, run.results.silences, end_of(run), colours, not_measurable);
        std::move(more.begin(), more.end(), std::back_inserter(out));
    }
    if (!not_measurable.empty()) {
        note += fmt::format("{}Not measurable, and not drawn: {} (delays below 0).", note.empty() ? "" : " ",
                            join(not_measurable, ", "));
    }
    return out;
}

/// The values of a series in the window, what holds at its begin included.
std::vector<double> in_window(Figure::Series const& s, double from_s, double to_s) {
    std::vector<double> out;
    for (std::size_t i = 0; i < s.values.size(); ++i) {
        bool const begun = i + 1 >= s.values.size() || static_cast<double>(s.times_ns[i + 1]) / 1e9 > from_s;
        if (begun && static_cast<double>(s.times_ns[i]) / 1e9 <= to_s && std::isfinite(s.values[i])) {
            out.push_back(s.values[i]);
        }
    }
    return out;
}

/// What is drawn over a value instead of time.
void over_values(Figure& f, FigureSettings const& settings, std::string otherwise) {
    f.x_label = settings.x_label.empty() ? std::move(otherwise) : settings.x_label;
    f.axis = f.id;
    f.marks.clear();
    f.shades.clear();
    f.zero_s = 0;
    f.zero_name.clear();
}

void distribution(Figure& f, FigureSettings const& settings, std::vector<Figure::Series> series) {
    double const from_s = f.from_s, to_s = f.to_s;
    over_values(f, settings, "value");
    std::vector<std::vector<double>> values;
    double low = INFINITY, high = -INFINITY;
    for (Figure::Series const& s : series) {
        values.push_back(in_window(s, from_s, to_s));
        for (double const v : values.back()) {
            low = std::min(low, v);
            high = std::max(high, v);
        }
    }
    if (!(low <= high)) {
        return;
    }
    bool const shares = settings.kind == Kind::ecdf;
    double const bin = settings.bin > 0 ? settings.bin : std::max((high - low) / 50, 1e-9);
    double const begin = std::floor(low / bin) * bin;
    auto const bins = static_cast<std::size_t>(std::min(kMostBins, std::floor((high - begin) / bin) + 1));
    for (std::size_t k = 0; k < series.size(); ++k) {
        Figure::Series& s = series[k];
        s.times_ns.clear();
        s.steps = true;
        if (shares) {
            std::sort(values[k].begin(), values[k].end());
            s.values.clear();
            for (std::size_t i = 0; i < values[k].size(); ++i) {
                s.times_ns.push_back(as_place(values[k][i]));
                s.values.push_back(100 * static_cast<double>(i + 1) / static_cast<double>(values[k].size()));
            }
        } else {
            s.values.assign(bins, 0);
            for (double const v : values[k]) {
                s.values[std::min(bins - 1, static_cast<std::size_t>((v - begin) / bin))] += 1;
            }
            for (std::size_t i = 0; i < bins; ++i) {
                s.times_ns.push_back(as_place(begin + static_cast<double>(i) * bin));
            }
        }
        f.series.push_back(std::move(s));
    }
    f.from_s = shares ? low : begin;
    f.to_s = shares ? std::max(high, low + least_width(low)) : begin + static_cast<double>(bins) * bin;
    if (f.y_label.empty()) {
        f.y_label = shares ? "share of the values, %" : fmt::format("values in a bin of {:.4g}", bin);
    }
}

double statistic_of(std::vector<double> const& values, std::string const& which) {
    if (which == "min") {
        return *std::min_element(values.begin(), values.end());
    }
    if (which == "max") {
        return *std::max_element(values.begin(), values.end());
    }
    double sum = 0;
    for (double const v : values) {
        sum += v;
    }
    return which == "mean" ? sum / static_cast<double>(values.size()) : values.back();
}

void bars(Figure& f, FigureSettings const& settings, std::vector<Figure::Series> const& series) {
    Figure::Series out;
    out.bars = true;
    out.colour = 0;
    out.name = settings.statistic;
    for (Figure::Series const& s : series) {
        std::vector<double> const values = in_window(s, f.from_s, f.to_s);
        if (!values.empty()) {
            out.times_ns.push_back(as_place(static_cast<double>(f.x_names.size())));
            out.values.push_back(statistic_of(values, settings.statistic));
            f.x_names.push_back(s.name);
        }
    }
    over_values(f, settings, " ");
    f.from_s = -0.5;
    f.to_s = static_cast<double>(f.x_names.size()) - 0.5;
    if (!out.values.empty()) {
        f.series.push_back(std::move(out));
    }
}

void scatter(Figure& f, FigureSettings const& settings, std::vector<Figure::Series> series, Drawn const& run) {
    double const from_s = f.from_s, to_s = f.to_s;
    over_values(f, settings, settings.x->text());
    f.from_s = INFINITY;
    f.to_s = -INFINITY;
    double const rms_over_s = settings.series.empty() ? 0 : settings.series.front().rms_over_s;
    SignalSeries x = values_of(*settings.x, run.results.signals, end_of(run));
    if (rms_over_s > 0) {
        x.values = sliding_rms(x.times_ns, x.values, rms_over_s);
    }
    for (Figure::Series& s : series) {
        std::vector<std::pair<double, double>> points;
        for (std::size_t i = 0; i < s.values.size(); ++i) {
            double const t = static_cast<double>(s.times_ns[i]) / 1e9;
            auto const after = std::upper_bound(x.times_ns.begin(), x.times_ns.end(), s.times_ns[i]);
            if (t >= from_s && t <= to_s && after != x.times_ns.begin()) {
                points.emplace_back(x.values[static_cast<std::size_t>(after - x.times_ns.begin()) - 1], s.values[i]);
            }
        }
        std::sort(points.begin(), points.end());
        s.times_ns.clear();
        s.values.clear();
        for (auto const& [px, py] : points) {
            s.times_ns.push_back(as_place(px));
            s.values.push_back(py);
            f.from_s = std::min(f.from_s, px);
            f.to_s = std::max(f.to_s, px);
        }
        s.points = true;
        s.connected = false;
        if (!points.empty()) {
            f.series.push_back(std::move(s));
        }
    }
    double const pad = std::max(least_width(f.from_s), 0.03 * (f.to_s - f.from_s));
    f.from_s -= pad;
    f.to_s += pad;
}

ReportSettings asked_settings(Node const& scenario) {
    Node const* report = scenario.find("report");
    return report == nullptr ? ReportSettings{} : read_report_settings(*report);
}

void from_expressions(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out) {
    Figure f = empty_figure(settings, run);
    if (f.from_s >= f.to_s) {
        return; // the event of its window did not happen, or is not in the run
    }
    std::vector<Figure::Series> series = all_series(settings, run, f.note);
    switch (settings.kind) {
    case Kind::histogram:
    case Kind::ecdf:
        distribution(f, settings, std::move(series));
        break;
    case Kind::bar:
        bars(f, settings, series);
        break;
    case Kind::scatter:
        scatter(f, settings, std::move(series), run);
        break;
    default:
        f.lanes = settings.kind == Kind::digital;
        f.series = std::move(series);
        for (Figure::Series& s : f.series) {
            shorten(s, f.from_s, f.to_s);
        }
        if (!f.lanes) {
            add_expected(f, settings, run.results);
        }
    }
    if (!f.series.empty()) {
        out.push_back(std::move(f));
    }
}

} // namespace

Figure empty_figure(FigureSettings const& settings, Drawn const& run) {
    Results const& r = run.results;
    Figure f;
    f.id = settings.name.name;
    f.title = settings.title;
    f.y_label = settings.label;
    f.right_label = settings.right_label;
    f.note = settings.note;
    f.log_y = settings.logarithmic;
    double const end_s = end_of(run);
    auto const instant = [&](std::optional<Moment> const& moment, double otherwise, double missing) {
        return !moment ? otherwise : std::clamp(instant_of(*moment, r.moments).value_or(missing), 0.0, end_s);
    };
    f.from_s = instant(settings.from, 0, end_s);
    f.to_s = instant(settings.until, end_s, 0);
    f.axis = settings.zoom.empty() ? fmt::format("time {} {}", shortest(f.from_s), shortest(f.to_s)) : settings.zoom;
    if (settings.zero) {
        if (auto const zero = instant_of(*settings.zero, r.moments)) {
            f.zero_s = *zero;
            f.zero_name = settings.zero->event.empty() ? to_text(*settings.zero) : settings.zero->event;
        }
    }
    for (FigureSettings::Line const& line : settings.lines) {
        f.lines.push_back({line.label, line.value});
    }
    for (FigureSettings::Band const& band : settings.bands) {
        f.bands.push_back({band.label, band.from, band.to});
    }
    for (FigureSettings::Mark const& mark : settings.marks) {
        auto const at = mark.at     ? instant_of(*mark.at, r.moments)
                        : mark.when ? first_true(*mark.when, r.signals, f.from_s, end_s)
                                    : std::nullopt;
        if (at && *at >= f.from_s && *at <= f.to_s) {
            f.marks.push_back({mark.label, *at, -1});
        }
    }
    for (FigureSettings::Shade const& shade : settings.shades) {
        if (shade.when) {
            auto more = spans(*shade.when, r.signals, end_s);
            std::move(more.begin(), more.end(), std::back_inserter(f.shades));
            f.shade_label = shade.label;
        }
    }
    return f;
}

Figure empty_plane(FigureSettings const& settings, Drawn const& run, std::string const& relay,
                   std::string const& x_label, std::string const& y_label) {
    Figure f = empty_figure(settings, run);
    if (!relay.empty()) {
        f.id += "_" + relay;
        f.title += ": " + relay;
    }
    f.x_label = settings.x_label.empty() ? x_label : settings.x_label;
    f.y_label = settings.label.empty() ? y_label : settings.label;
    f.axis = f.id;
    f.marks.clear();
    f.shades.clear();
    return f;
}

std::vector<Figure> make_figures(ReportSettings const& settings, Drawn const& run) {
    std::vector<Figure> out;
    for (FigureSettings const& figure : settings.figures) {
        switch (figure.kind) {
        case Kind::message_intervals:
            message_intervals(figure, run, out);
            break;
        case Kind::sample_rate:
            sample_rate(figure, run, out);
            break;
        case Kind::frame_intervals:
            frame_intervals(figure, run, out);
            break;
        case Kind::forged_sample:
            forged_samples(figure, run, out);
            break;
        case Kind::trip_comparison:
            trip_comparisons(figure, run, out);
            break;
        case Kind::roc:
            roc_curves(figure, run, out);
            break;
        case Kind::restraint:
            restraint_planes(figure, run, out);
            break;
        case Kind::impedance:
            impedance_planes(figure, run, out);
            break;
        case Kind::time_current:
            time_current_curves(figure, run, out);
            break;
        default:
            from_expressions(figure, run, out);
        }
    }
    return out;
}

std::string_view unasked_figures(Node const& scenario) {
    ReportSettings const asked = asked_settings(scenario);
    return asked.figures.empty() || asked.usual ? kUsualFigures : std::string_view{};
}

ReportSettings report_settings(Node const& scenario) {
    ReportSettings out = asked_settings(scenario);
    if (std::string_view const unasked = unasked_figures(scenario); !unasked.empty()) {
        config::Diagnostics ignored;
        auto const usual = config::parse_yaml(unasked, config::make_source("usual_figures.yaml", unasked), ignored);
        ReportSettings more = usual ? read_report_settings(*usual) : ReportSettings{};
        for (FigureSettings& figure : more.figures) {
            bool const own = std::any_of(out.figures.begin(), out.figures.end(),
                                         [&](auto const& f) { return f.name.name == figure.name.name; });
            if (!own) {
                out.figures.push_back(std::move(figure));
            }
        }
    }
    return out;
}

} // namespace gridspace::launcher

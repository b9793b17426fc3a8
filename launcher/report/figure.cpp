// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/figure.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

namespace gridspace::launcher {
namespace {

// Okabe and Ito: told apart with any colour vision.
constexpr std::array<std::string_view, 8> kPalette{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                   "#E69F00", "#56B4E9", "#6A51A3", "#7F7F7F"};
constexpr double kWidth = 860, kHeight = 300, kLeft = 62, kRight = 14, kTop = 26, kBottom = 36;
constexpr std::size_t kMostPoints = 3000;

std::string_view colour(int wanted, std::size_t place) {
    return kPalette[(wanted >= 0 ? static_cast<std::size_t>(wanted) : place) % kPalette.size()];
}

struct Range {
    double low{0}, high{1};
};

/// On the axis: the value, or its logarithm. Nothing that was counted is drawn half a one down.
double scaled(Figure const& f, double v) {
    return !f.log_y ? v : v > 0 ? std::log10(v) : f.x_label.empty() ? std::nan("") : std::log10(0.5);
}

Range value_range(Figure const& f) {
    Range r{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    auto const include = [&](double v) {
        if (std::isfinite(v)) {
            r.low = std::min(r.low, v);
            r.high = std::max(r.high, v);
        }
    };
    for (Figure::Series const& s : f.series) {
        for (std::size_t i = 0; i < s.values.size(); ++i) { // what a line holds at the begin of the window is drawn too
            bool const begun = i + 1 >= s.values.size() || static_cast<double>(s.times_ns[i + 1]) / 1e9 >= f.from_s;
            if (begun && static_cast<double>(s.times_ns[i]) / 1e9 <= f.to_s) {
                include(scaled(f, s.values[i]));
            }
        }
    }
    for (Figure::Line const& line : f.lines) {
        include(scaled(f, line.value));
    }
    if (!(r.low <= r.high)) {
        return {0, 1};
    }
    double const pad = r.high > r.low ? 0.05 * (r.high - r.low) : std::max(1e-6, 0.05 * std::abs(r.high));
    return {r.low - pad, r.high + pad};
}

/// Round numbers between low and high, about `count` of them.
std::vector<double> ticks(double low, double high, int count) {
    double const raw = (high - low) / count;
    double const magnitude = std::pow(10, std::floor(std::log10(raw)));
    double step = magnitude;
    for (double const m : {1.0, 2.0, 2.5, 5.0, 10.0}) {
        step = m * magnitude;
        if (step >= raw) {
            break;
        }
    }
    std::vector<double> out;
    for (double v = std::ceil(low / step) * step; v <= high + 1e-9 * step; v += step) {
        out.push_back(std::abs(v) < 1e-12 * step ? 0 : v);
    }
    return out;
}

/// What is drawn of a series: at most so many points, the extremes of each bucket kept.
std::vector<std::pair<double, double>> drawn_points(Figure::Series const& s, double from_s, double to_s) {
    std::vector<std::pair<double, double>> points;
    std::size_t first = 0, last = s.values.size();
    while (first + 1 < last && static_cast<double>(s.times_ns[first + 1]) / 1e9 < from_s) {
        ++first;
    }
    while (last > first + 1 && static_cast<double>(s.times_ns[last - 1]) / 1e9 > to_s) {
        --last;
    }
    std::size_t const count = last - first;
    std::size_t const bucket = std::max<std::size_t>(1, count / (kMostPoints / 2));
    auto const point = [&](std::size_t i) {
        points.emplace_back(static_cast<double>(s.times_ns[i]) / 1e9, s.values[i]);
    };
    for (std::size_t i = first; i < last; i += bucket) {
        std::size_t low = i, high = i;
        for (std::size_t k = i; k < std::min(last, i + bucket); ++k) {
            low = s.values[k] < s.values[low] ? k : low;
            high = s.values[k] > s.values[high] ? k : high;
        }
        point(std::min(low, high));
        if (low != high) {
            point(std::max(low, high));
        }
    }
    if (count > 0 && (points.empty() || points.back().first < static_cast<double>(s.times_ns[last - 1]) / 1e9)) {
        point(last - 1);
    }
    return points;
}

} // namespace

TimeUnit time_unit(double span_s) {
    return span_s > 7200  ? TimeUnit{"h", 3600}
           : span_s > 600 ? TimeUnit{"min", 60}
           : span_s < 0.5 ? TimeUnit{"ms", 1e-3}
                          : TimeUnit{"s", 1};
}

std::string to_svg(Figure const& f) {
    TimeUnit const unit = f.x_label.empty() ? time_unit(f.to_s - f.from_s) : TimeUnit{f.x_label, 1};
    Range const y = value_range(f);
    double const span = std::max(1e-12, f.to_s - f.from_s);
    auto const px = [&](double t) { return kLeft + (t - f.from_s) / span * (kWidth - kLeft - kRight); };
    auto const py = [&](double v) {
        return kTop + (y.high - scaled(f, v)) / (y.high - y.low) * (kHeight - kTop - kBottom);
    };
    double const x0 = kLeft, x1 = kWidth - kRight, y0 = kHeight - kBottom, y1 = kTop;

    std::string out = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\" "
        "data-axis=\"{}\" data-from=\"{}\" data-to=\"{}\" data-unit=\"{}\" data-unit-s=\"{}\" "
        "data-left=\"{}\" data-right=\"{}\" "
        "data-top=\"{}\" data-bottom=\"{}\" data-low=\"{}\" data-high=\"{}\">\n",
        kWidth, kHeight, escape_markup(f.title), escape_markup(f.axis), shortest(f.from_s), shortest(f.to_s),
        escape_markup(unit.name), unit.seconds, x0, x1, y1, y0, shortest(y.low), shortest(y.high));
    out += "<style>text{font:11px system-ui,-apple-system,'Segoe UI',sans-serif;fill:currentColor}"
           ".grid{stroke:currentColor;stroke-opacity:.13}.axis{stroke:currentColor;stroke-opacity:.55}"
           ".limit{stroke:currentColor;stroke-opacity:.6;stroke-dasharray:2 3}.mark{stroke-dasharray:5 3}"
           ".data{fill:none;stroke-width:1.5;stroke-linejoin:round}.dim{fill-opacity:.75;font-size:10px}</style>\n";
    out += fmt::format("<g class=\"ticks\">\n");
    std::vector<double> y_ticks = ticks(y.low, y.high, 6);
    if (f.log_y) {
        y_ticks.clear();
        for (double decade = std::ceil(y.low); decade <= y.high; ++decade) {
            y_ticks.push_back(std::pow(10, decade));
        }
    }
    for (double const v : y_ticks) {
        out += fmt::format(
            "<line class=\"grid\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/><text x=\"{}\" y=\"{:.1f}\" "
            "text-anchor=\"end\">{:.5g}</text>\n",
            x0, x1, py(v), py(v), x0 - 6, py(v) + 4, v);
    }
    for (double const v : ticks(f.from_s / unit.seconds, f.to_s / unit.seconds, 10)) {
        double const x = px(v * unit.seconds);
        out += fmt::format("<g class=\"tx\"><line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" "
                           "y2=\"{2}\"/><text x=\"{0:.1f}\" y=\"{3}\" "
                           "text-anchor=\"middle\">{4:.6g}</text></g>\n",
                           x, y0, y1, y0 + 15, v);
    }
    out += "</g>\n";
    out += fmt::format("<clipPath id=\"clip-{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n",
                       f.id, x0, y1, x1 - x0, y0 - y1);
    out += fmt::format("<g clip-path=\"url(#clip-{})\"><g class=\"plot\">\n", f.id);
    for (Figure::Shade const& shade : f.shades) {
        out += fmt::format("<rect class=\"shade\" x=\"{:.2f}\" y=\"{}\" width=\"{:.2f}\" height=\"{}\" "
                           "fill=\"#E69F00\" fill-opacity=\".16\"/>\n",
                           px(shade.from_s), y1, px(shade.to_s) - px(shade.from_s), y0 - y1);
    }
    for (Figure::Line const& line : f.lines) {
        out += fmt::format("<line class=\"limit\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" "
                           "vector-effect=\"non-scaling-stroke\"/>\n",
                           x0, x1, py(line.value), py(line.value));
    }
    for (std::size_t i = 0; i < f.series.size(); ++i) {
        Figure::Series const& s = f.series[i];
        std::string path, dots;
        double last_y = 0;
        for (auto const& [t, v] : drawn_points(s, f.from_s, f.to_s)) {
            if (!std::isfinite(scaled(f, v))) {
                continue;
            }
            double const x = px(t), yy = py(v);
            if (s.points) {
                dots += fmt::format("M{:.2f} {:.2f}h.01", x, yy);
            }
            if (path.empty()) {
                path = fmt::format("M{:.2f} {:.2f}", x, yy);
            } else {
                path += s.steps ? fmt::format("L{:.2f} {:.2f}L{:.2f} {:.2f}", x, last_y, x, yy)
                                : fmt::format("L{:.2f} {:.2f}", x, yy);
            }
            last_y = yy;
        }
        if (s.steps && !path.empty()) {
            path += fmt::format("L{:.2f} {:.2f}", px(f.to_s), last_y);
        }
        out += fmt::format("<path class=\"data\" d=\"{}\" stroke=\"{}\"{} vector-effect=\"non-scaling-stroke\"/>\n",
                           path, colour(s.colour, i), s.dashed ? " stroke-dasharray=\"6 3\"" : "");
        if (!dots.empty()) { // dots that stay round when the drawing is stretched
            out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"6\" stroke-linecap=\"round\" "
                               "vector-effect=\"non-scaling-stroke\"/>\n",
                               dots, colour(s.colour, i));
        }
    }
    for (std::size_t i = 0; i < f.marks.size(); ++i) {
        Figure::Mark const& mark = f.marks[i];
        out += fmt::format("<line class=\"mark\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" stroke=\"{3}\" "
                           "vector-effect=\"non-scaling-stroke\"/>\n",
                           px(mark.time_s), y0, y1, mark.colour >= 0 ? colour(mark.colour, i) : "currentColor");
    }
    out += "</g></g>\n";
    for (Figure::Line const& line : f.lines) {
        out += fmt::format("<text class=\"dim\" x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n", x1 - 4,
                           py(line.value) - 3, escape_markup(line.label));
    }
    std::vector<double> row_ends; // of the labels in each row: what would overlap goes one row down
    for (Figure::Mark const& mark : f.marks) {
        double const x = px(mark.time_s), half = 3.2 * static_cast<double>(mark.label.size()) + 2;
        std::size_t row = 0;
        while (row < row_ends.size() && row_ends[row] > x - half) {
            ++row;
        }
        row_ends.resize(std::max(row_ends.size(), row + 1));
        row_ends[row] = x + half;
        out +=
            fmt::format("<text class=\"dim tm\" data-t=\"{}\" x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                        shortest(mark.time_s), x, y1 + 10 + 11 * static_cast<double>(row), escape_markup(mark.label));
    }
    out += fmt::format("<line class=\"axis\" x1=\"{0}\" x2=\"{1}\" y1=\"{2}\" y2=\"{2}\"/><line class=\"axis\" "
                       "x1=\"{0}\" x2=\"{0}\" y1=\"{2}\" y2=\"{3}\"/>\n",
                       x0, x1, y0, y1);
    out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text><text x=\"{}\" y=\"14\">{}</text>\n", x1,
                       kHeight - 4, f.x_label.empty() ? "time, " + unit.name : escape_markup(f.x_label), x0 - 40,
                       escape_markup(f.y_label));
    double x = x0 + 130;
    for (std::size_t i = 0; i < f.series.size(); ++i) {
        out +=
            fmt::format("<line x1=\"{}\" x2=\"{}\" y1=\"10\" y2=\"10\" stroke=\"{}\" stroke-width=\"2.5\"{}/><text "
                        "x=\"{}\" y=\"14\">{}</text>\n",
                        x, x + 16, colour(f.series[i].colour, i), f.series[i].dashed ? " stroke-dasharray=\"5 3\"" : "",
                        x + 21, escape_markup(f.series[i].name));
        x += 34 + 6.4 * static_cast<double>(f.series[i].name.size());
    }
    if (!f.shades.empty()) {
        out += fmt::format("<rect x=\"{}\" y=\"5\" width=\"16\" height=\"10\" fill=\"#E69F00\" "
                           "fill-opacity=\".3\"/><text x=\"{}\" y=\"14\">{}</text>\n",
                           x, x + 21, escape_markup(f.shade_label));
    }
    return out + "</svg>\n";
}

std::string to_csv(Figure const& f) {
    std::string out = f.x_label.empty() ? "time_s" : "x";
    std::set<std::int64_t> times;
    for (Figure::Series const& s : f.series) {
        out += "," + s.name;
        times.insert(s.times_ns.begin(), s.times_ns.end());
    }
    out += "\n";
    std::vector<std::size_t> next(f.series.size(), 0);
    for (std::int64_t const t : times) {
        out += shortest(static_cast<double>(t) / 1e9);
        for (std::size_t i = 0; i < f.series.size(); ++i) {
            Figure::Series const& s = f.series[i];
            while (next[i] < s.times_ns.size() && s.times_ns[next[i]] <= t) {
                ++next[i];
            }
            out += next[i] == 0 ? "," : "," + shortest(s.values[next[i] - 1]);
        }
        out += "\n";
    }
    return out;
}

namespace {

/// A JSON string that stands in a script element of a page: nothing in it ends the element, or a line (U+2028).
std::string script_text(std::string_view text) {
    std::string out = nlohmann::json(text).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
    for (std::size_t at = 0; (at = out.find('<', at)) != std::string::npos;) {
        out.replace(at, 1, "\\u003c");
    }
    return out;
}

} // namespace

std::string to_json(Figure const& f) {
    std::string out = fmt::format("{{\"id\":{},\"series\":[", script_text(f.id));
    for (std::size_t i = 0; i < f.series.size(); ++i) {
        std::string times, values;
        for (auto const& [t, v] : drawn_points(f.series[i], f.from_s, f.to_s)) {
            times += fmt::format("{}{:.6g}", times.empty() ? "" : ",", t);
            values += std::isfinite(v) ? fmt::format("{}{:.6g}", values.empty() ? "" : ",", v)
                                       : fmt::format("{}null", values.empty() ? "" : ",");
        }
        out += fmt::format("{}{{\"name\":{},\"colour\":\"{}\",\"t\":[{}],\"v\":[{}]}}", i == 0 ? "" : ",",
                           script_text(f.series[i].name), colour(f.series[i].colour, i), times, values);
    }
    return out + "]}";
}

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/scatter.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>

namespace gridspace::cli {
namespace {

constexpr double kWidth = 760, kHeight = 440, kLeft = 70, kRight = 20, kTop = 40, kBottom = 56;
constexpr std::array<char const*, 6> kColours{"#1f6feb", "#d1495b", "#2a9d8f", "#8d6cab", "#e09f3e", "#555555"};

struct Axis {
    double low{0}, high{1};
    bool log{false};
    [[nodiscard]] double place(double v) const { // 0 to 1
        double const a = log ? std::log10(low) : low, b = log ? std::log10(high) : high,
                     x = log ? std::log10(std::max(v, low)) : v;
        return b > a ? (x - a) / (b - a) : 0.5;
    }
    [[nodiscard]] std::vector<double> ticks() const {
        std::vector<double> out;
        if (log) {
            for (double decade = std::pow(10, std::floor(std::log10(low))); decade <= high * 1.001; decade *= 10) {
                for (double const m : {1.0, 2.0, 5.0}) {
                    if (decade * m >= low * 0.999 && decade * m <= high * 1.001) {
                        out.push_back(decade * m);
                    }
                }
            }
            return out;
        }
        double const raw = (high - low) / 6, magnitude = std::pow(10, std::floor(std::log10(raw)));
        double const step = magnitude * (raw / magnitude > 5   ? 10
                                         : raw / magnitude > 2 ? 5
                                         : raw / magnitude > 1 ? 2
                                                               : 1);
        for (double v = std::ceil(low / step) * step; v <= high + step * 1e-9; v += step) {
            out.push_back(v);
        }
        return out;
    }
};

Axis axis_of(std::vector<Scatter::Point> const& points, double Scatter::Point::* member, bool log) {
    Axis a;
    a.log = log;
    double low = 1e300, high = -1e300;
    for (Scatter::Point const& p : points) {
        if (!log || p.*member > 0) {
            low = std::min(low, p.*member);
            high = std::max(high, p.*member);
        }
    }
    if (low > high) {
        low = log ? 1 : 0;
        high = 10;
    }
    a.low = log ? low / 1.3 : std::min(low, 0.0);
    a.high = log ? high * 1.3 : (high > a.low ? high * 1.08 : a.low + 1);
    return a;
}

} // namespace

std::string to_svg(Scatter const& plot) {
    Axis const x = axis_of(plot.points, &Scatter::Point::x, plot.x_log),
               y = axis_of(plot.points, &Scatter::Point::y, plot.y_log);
    double const w = kWidth - kLeft - kRight, h = kHeight - kTop - kBottom;
    auto const px = [&](double v) { return kLeft + w * x.place(v); };
    auto const py = [&](double v) { return kTop + h * (1 - y.place(v)); };
    std::string out = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" font-family=\"sans-serif\" "
        "font-size=\"12\">\n"
        "<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n<text x=\"{2}\" y=\"22\" font-size=\"15\">{3}</text>\n",
        kWidth, kHeight, kLeft, escape_markup(plot.title));
    for (double const t : x.ticks()) {
        out += fmt::format("<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" stroke=\"#ddd\"/><text "
                           "x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4:g}</text>\n",
                           px(t), kTop, kTop + h, kTop + h + 18, t);
    }
    for (double const t : y.ticks()) {
        out += fmt::format("<line x1=\"{1}\" x2=\"{2}\" y1=\"{0:.1f}\" y2=\"{0:.1f}\" stroke=\"#ddd\"/><text x=\"{3}\" "
                           "y=\"{4:.1f}\" text-anchor=\"end\">{5:g}</text>\n",
                           py(t), kLeft, kLeft + w, kLeft - 6, py(t) + 4, t);
    }
    out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n<text transform=\"translate(18 {}) "
                       "rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                       kLeft + w / 2, kHeight - 14, escape_markup(plot.x_label), kTop + h / 2,
                       escape_markup(plot.y_label));
    std::map<int, std::string> lines;
    for (Scatter::Point const& p : plot.points) {
        char const* const colour = kColours[static_cast<std::size_t>(p.group) % kColours.size()];
        out += fmt::format("<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"4\" fill=\"{2}\"/><text x=\"{3:.1f}\" "
                           "y=\"{4:.1f}\" fill=\"{2}\">{5}</text>\n",
                           px(p.x), py(p.y), colour, px(p.x) + 6, py(p.y) - 5, escape_markup(p.label));
        lines[p.group] += fmt::format("{:.1f},{:.1f} ", px(p.x), py(p.y));
    }
    for (auto const& [group, line] : lines) {
        if (plot.connect) {
            out += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\"/>\n", line,
                               kColours[static_cast<std::size_t>(group) % kColours.size()]);
        }
    }
    return out + "</svg>\n";
}

} // namespace gridspace::cli

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The drawing of a figure: from top to bottom the legend, the labels of the marks, the plot, the axis.
#include "common/text.hpp"
#include "launcher/report/axis_range.hpp"
#include "launcher/report/figure.hpp"
#include "launcher/report/ticks.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace gridspace::launcher {
namespace {

constexpr double kWidth = 860, kLaneHeight = 26, kBottomMargin = 36, kRow = 14, kMarkRow = 12;
constexpr double kCharacter = 6.2, kSmallCharacter = 5.6; // widths of text of 11 and 10 pixels
constexpr std::size_t kMaxNamed = 24;                     // series in the legend

double width_of(std::string const& text, double character = kCharacter) {
    auto const letters = std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; });
    return character * static_cast<double>(letters);
}

class Drawing {
  public:
    explicit Drawing(Figure const& figure) : f_{figure} {
        lay_out();
        left_ = f_.y_range ? AxisRange{f_.y_range->first, f_.y_range->second} : range_of(f_, false);
        right_ = range_of(f_, true);
    }

    std::string svg() {
        out_ = fmt::format(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\" "
            "data-axis=\"{}\" data-from=\"{}\" data-to=\"{}\" data-zero=\"{}\" data-unit=\"{}\" data-unit-s=\"{}\" "
            "data-left=\"{}\" data-right=\"{}\" data-top=\"{}\" data-bottom=\"{}\">\n",
            kWidth, y0_ + kBottomMargin, escape_markup(f_.title), escape_markup(f_.axis), shortest(f_.from_s),
            shortest(f_.to_s), shortest(f_.zero_s), escape_markup(unit_.name), unit_.seconds, x0_, x1_, y1_, y0_);
        out_ += "<style>text{font:11px system-ui,-apple-system,'Segoe UI',sans-serif;fill:currentColor}"
                ".grid{stroke:currentColor;stroke-opacity:.13}.axis{stroke:currentColor;stroke-opacity:.55}"
                ".limit{stroke:currentColor;stroke-opacity:.6;stroke-dasharray:2 3}.mark{stroke-dasharray:5 3}"
                ".data{fill:none;stroke-width:1.5;stroke-linejoin:round}.dim{fill-opacity:.8;font-size:10px}"
                ".halo{paint-order:stroke;stroke:var(--card,#fff);stroke-width:3px;stroke-linejoin:round}</style>\n";
        out_ += "<g class=\"ticks\">\n";
        y_ticks();
        x_ticks();
        out_ += "</g>\n";
        out_ +=
            fmt::format("<clipPath id=\"clip-{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n",
                        f_.id, x0_, marks_top_, x1_ - x0_, y0_ - marks_top_);
        out_ += fmt::format("<g clip-path=\"url(#clip-{})\"><g class=\"plot\">\n", f_.id);
        areas();
        for (std::size_t i = 0; i < f_.series.size(); ++i) {
            f_.series[i].bars ? bars(i) : path(i);
        }
        mark_lines();
        out_ += "</g></g>\n";
        line_labels();
        mark_labels();
        axes();
        out_ += legend_;
        return out_ + "</svg>\n";
    }

  private:
    struct Row {
        std::size_t row{0};
        bool flipped{false}; ///< the label is at the left of its line
    };

    /// Legend and labels of marks first: they say where the plot begins.
    void lay_out() {
        unit_ = f_.x_label.empty() ? time_unit(f_.to_s - f_.from_s) : TimeUnit{f_.x_label, 1};
        if (f_.lanes) {
            for (Figure::Series const& s : f_.series) {
                x0_ = std::clamp(width_of(s.name) + 26, x0_, 260.0);
            }
        }
        bool const right = std::any_of(f_.series.begin(), f_.series.end(), [](auto const& s) { return s.right_axis; });
        x1_ = kWidth - (right ? 56 : 14);
        double const row_end = kWidth - 14 - (f_.right_label.empty() ? 0 : width_of(f_.right_label) + 16);
        double const begin = f_.y_label.empty() ? x0_ : std::max(x0_, x0_ - 40 + width_of(f_.y_label) + 24);
        double x = begin, y = kRow;
        auto const place = [&](double width) {
            if (x + width > row_end && x > begin) {
                x = begin;
                y += kRow;
            }
        };
        for (std::size_t i = 0; i < f_.series.size() && !f_.lanes && f_.x_names.empty(); ++i) {
            Figure::Series const& s = f_.series[i];
            if (s.name.empty()) { // it belongs to another one
                continue;
            }
            std::string const name = i < kMaxNamed ? s.name : fmt::format("and {} more", f_.series.size() - i);
            place(21 + width_of(name));
            if (i < kMaxNamed) {
                legend_ += fmt::format("<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{}\" y2=\"{}\" stroke=\"{}\" "
                                       "stroke-width=\"2.5\"{}/>",
                                       x, x + 16, y - 4, y - 4, palette_colour(s.colour, i),
                                       s.dashed ? " stroke-dasharray=\"5 3\"" : "");
            }
            legend_ += fmt::format("<text x=\"{:.1f}\" y=\"{}\">{}</text>\n", x + 21, y, escape_markup(name));
            x += 37 + width_of(name);
            if (i == kMaxNamed) {
                break;
            }
        }
        if (!f_.shades.empty()) {
            place(21 + width_of(f_.shade_label));
            legend_ += fmt::format("<rect x=\"{:.1f}\" y=\"{}\" width=\"16\" height=\"10\" fill=\"#E69F00\" "
                                   "fill-opacity=\".3\"/><text x=\"{:.1f}\" y=\"{}\">{}</text>\n",
                                   x, y - 9, x + 21, y, escape_markup(f_.shade_label));
        }
        marks_top_ = y + 8;
        y1_ = marks_top_ + kMarkRow * static_cast<double>(mark_rows());
        y0_ = y1_ + (f_.lanes ? kLaneHeight * static_cast<double>(f_.series.size()) : f_.plot_height);
    }

    /// A label stands at the right of its own line (at the left near the right end), in a row above the labels of all
    /// marks that it reaches over: no line crosses a label. Returns how many rows that takes.
    std::size_t mark_rows() {
        rows_.assign(f_.marks.size(), {});
        std::vector<std::size_t> order;
        for (std::size_t i = 0; i < f_.marks.size(); ++i) {
            double const x = px(f_.marks[i].time_s);
            rows_[i].flipped = x + label_width(i) > kWidth - 4;
            if (x >= x0_ - 1 && x <= x1_ + 1) {
                order.push_back(i);
            }
        }
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            auto const key = [&](std::size_t i) {
                return std::pair{rows_[i].flipped, rows_[i].flipped ? f_.marks[i].time_s : -f_.marks[i].time_s};
            };
            return key(a) < key(b);
        });
        std::size_t count = 0;
        for (std::size_t n = 0; n < order.size(); ++n) {
            Row& own = rows_[order[n]];
            double const x = px(f_.marks[order[n]].time_s), width = label_width(order[n]);
            double const from = own.flipped ? x - width : x, to = own.flipped ? x : x + width;
            for (std::size_t before = 0; before < n; ++before) {
                double const other = px(f_.marks[order[before]].time_s);
                double const w = label_width(order[before]);
                bool const flipped = rows_[order[before]].flipped;
                if (other - (flipped ? w : 0) < to && other + (flipped ? 0 : w) > from) {
                    own.row = std::max(own.row, rows_[order[before]].row + 1);
                }
            }
            count = std::max(count, own.row + 1);
        }
        return count;
    }

    double label_width(std::size_t i) const { return width_of(f_.marks[i].label, kSmallCharacter) + 8; }
    double row_y(Row const& row) const { return y1_ - kMarkRow * static_cast<double>(row.row) - 3; }

    double px(double t) const { return x0_ + (t - f_.from_s) / std::max(1e-12, f_.to_s - f_.from_s) * (x1_ - x0_); }
    double py(double v, bool right = false) const {
        AxisRange const& r = right ? right_ : left_;
        return y1_ + (r.high - on_axis(f_, v)) / (r.high - r.low) * (y0_ - y1_);
    }
    double lane_y(std::size_t lane, bool up) const {
        return y1_ + kLaneHeight * (static_cast<double>(lane) + (up ? 0.15 : 0.85));
    }

    void y_ticks() {
        if (f_.lanes) {
            for (std::size_t i = 0; i < f_.series.size(); ++i) {
                out_ += fmt::format("<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n", x0_ - 8,
                                    (lane_y(i, true) + lane_y(i, false)) / 2 + 4, escape_markup(f_.series[i].name));
            }
            return;
        }
        std::vector<double> values = ticks(left_.low, left_.high, 6);
        if (f_.log_y) {
            values = decades(left_.low, left_.high);
        }
        for (double const v : values) {
            out_ += fmt::format("<line class=\"grid\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/><text x=\"{}\" "
                                "y=\"{:.1f}\" text-anchor=\"end\">{:.5g}</text>\n",
                                x0_, x1_, py(v), py(v), x0_ - 6, py(v) + 4, v);
        }
        if (x1_ < kWidth - 14) {
            for (double const v : ticks(right_.low, right_.high, 6)) {
                out_ += fmt::format("<text x=\"{}\" y=\"{:.1f}\">{:.5g}</text>\n", x1_ + 6, py(v, true) + 4, v);
            }
        }
    }

    void x_ticks() {
        auto const tick = [&](double t, std::string const& text) {
            out_ += fmt::format("<g class=\"tx\"><line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" "
                                "y2=\"{2}\"/><text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4}</text></g>\n",
                                px(t), y0_, y1_, y0_ + 15, escape_markup(text));
        };
        std::size_t const every = 1 + f_.x_names.size() / 24; // more names would lie on each other
        for (std::size_t i = 0; i < f_.x_names.size(); i += every) {
            tick(static_cast<double>(i), f_.x_names[i]);
        }
        if (!f_.x_names.empty()) {
            return;
        }
        if (f_.log_x) {
            for (double const v : decades(f_.from_s, f_.to_s)) {
                tick(std::log10(v), fmt::format("{:.4g}", v));
            }
            return;
        }
        for (double const v :
             ticks((f_.from_s - f_.zero_s) / unit_.seconds, (f_.to_s - f_.zero_s) / unit_.seconds, 10, unit_.name)) {
            tick(f_.zero_s + v * unit_.seconds, fmt::format("{:.6g}", v));
        }
    }

    void areas() {
        for (Figure::Shade const& shade : f_.shades) {
            out_ += fmt::format("<rect class=\"shade\" x=\"{:.2f}\" y=\"{}\" width=\"{:.2f}\" height=\"{}\" "
                                "fill=\"#E69F00\" fill-opacity=\".16\"/>\n",
                                px(shade.from_s), y1_, px(shade.to_s) - px(shade.from_s), y0_ - y1_);
        }
        for (Figure::Band const& band : f_.bands) {
            out_ += fmt::format("<rect x=\"{}\" y=\"{:.1f}\" width=\"{}\" height=\"{:.1f}\" fill=\"#009E73\" "
                                "fill-opacity=\".1\"/>\n",
                                x0_, py(band.high), x1_ - x0_, py(band.low) - py(band.high));
        }
        for (Figure::Line const& line : f_.lines) {
            out_ += fmt::format("<line class=\"limit\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" "
                                "vector-effect=\"non-scaling-stroke\"/>\n",
                                x0_, x1_, py(line.value), py(line.value));
        }
    }

    void path(std::size_t i) {
        Figure::Series const& s = f_.series[i];
        bool const steps = s.steps || f_.lanes;
        std::string path, dots, names;
        double last_y = 0;
        bool down = false; // the pen
        std::size_t place = 0;
        for (auto const& [t, v] : drawn_points(s, f_.from_s, f_.to_s)) {
            std::size_t const own = place++;
            if (std::isnan(v)) { // nothing from here on
                path += steps && down ? fmt::format("L{:.2f} {:.2f}", px(t), last_y) : "";
                down = false;
                continue;
            }
            if (!std::isfinite(on_axis(f_, v))) {
                continue;
            }
            double const x = px(t), y = f_.lanes ? lane_y(i, s.double_point ? v == 1 : v != 0) : py(v, s.right_axis);
            if (s.points) {
                dots += fmt::format("M{:.2f} {:.2f}h.01", x, y);
            }
            if (own < s.point_names.size() && !s.point_names[own].empty()) {
                names += fmt::format("<text class=\"dim halo\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x + 6, y + 12,
                                     escape_markup(s.point_names[own]));
            }
            path += !down   ? fmt::format("M{:.2f} {:.2f}", x, y)
                    : steps ? fmt::format("L{:.2f} {:.2f}L{:.2f} {:.2f}", x, last_y, x, y)
                            : fmt::format("L{:.2f} {:.2f}", x, y);
            down = true;
            last_y = y;
        }
        if (steps && down) {
            path += fmt::format("L{:.2f} {:.2f}", px(f_.to_s), last_y);
        }
        if (s.connected) {
            out_ +=
                fmt::format("<path class=\"data\" d=\"{}\" stroke=\"{}\"{} vector-effect=\"non-scaling-stroke\"/>\n",
                            path, palette_colour(s.colour, i), s.dashed ? " stroke-dasharray=\"6 3\"" : "");
        }
        if (!dots.empty()) { // dots that stay round when the drawing is stretched
            out_ += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" "
                                "stroke-linecap=\"round\" vector-effect=\"non-scaling-stroke\"/>\n",
                                dots, palette_colour(s.colour, i),
                                s.path        ? 7
                                : s.connected ? 6
                                              : 4);
        }
        out_ += names;
    }

    void bars(std::size_t i) {
        Figure::Series const& s = f_.series[i];
        for (std::size_t k = 0; k < s.values.size(); ++k) {
            double const x = static_cast<double>(s.times_ns[k]) / 1e9;
            double const top = py(std::max(0.0, s.values[k])), bottom = py(std::min(0.0, s.values[k]));
            out_ +=
                fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>\n",
                            px(x - 0.35), top, px(x + 0.35) - px(x - 0.35), bottom - top, palette_colour(s.colour, i));
            out_ += fmt::format("<text class=\"dim\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:.4g}</text>\n",
                                px(x), top - 3, s.values[k]);
        }
    }

    void mark_lines() {
        for (std::size_t i = 0; i < f_.marks.size(); ++i) {
            Figure::Mark const& mark = f_.marks[i];
            out_ += fmt::format("<line class=\"mark\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" "
                                "stroke=\"{3}\" vector-effect=\"non-scaling-stroke\"/>\n",
                                px(mark.time_s), y0_, row_y(rows_[i]) - 8,
                                mark.colour >= 0 ? palette_colour(mark.colour, i) : "currentColor");
        }
    }

    void mark_labels() {
        for (std::size_t i = 0; i < f_.marks.size(); ++i) {
            Figure::Mark const& mark = f_.marks[i];
            double const x = px(mark.time_s);
            if (x < x0_ - 1 || x > x1_ + 1) {
                continue;
            }
            out_ += fmt::format("<text class=\"dim tm\" data-t=\"{}\" x=\"{:.1f}\" y=\"{}\" dx=\"{}\" "
                                "text-anchor=\"{}\">{}</text>\n",
                                shortest(mark.time_s), x, row_y(rows_[i]), rows_[i].flipped ? -4 : 4,
                                rows_[i].flipped ? "end" : "start", escape_markup(mark.label));
        }
    }

    /// Of lines and bands, at the right end; pushed apart where they would lie on each other.
    void line_labels() {
        std::vector<std::pair<double, std::string>> labels;
        for (Figure::Line const& line : f_.lines) {
            labels.emplace_back(py(line.value) - 3, line.label);
        }
        for (Figure::Band const& band : f_.bands) {
            labels.emplace_back((py(band.low) + py(band.high)) / 2 + 4, band.label);
        }
        std::stable_sort(labels.begin(), labels.end(), [](auto const& a, auto const& b) { return a.first > b.first; });
        double last = std::numeric_limits<double>::infinity();
        for (auto& [y, label] : labels) {
            y = std::min(y, last - 11);
            last = y;
            out_ += fmt::format("<text class=\"dim halo\" x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                                x1_ - 4, y, escape_markup(label));
        }
    }

    void axes() {
        out_ += fmt::format("<line class=\"axis\" x1=\"{0}\" x2=\"{1}\" y1=\"{2}\" y2=\"{2}\"/><line class=\"axis\" "
                            "x1=\"{0}\" x2=\"{0}\" y1=\"{2}\" y2=\"{3}\"/>\n",
                            x0_, x1_, y0_, y1_);
        if (f_.zero_axes) {
            out_ += fmt::format("<path class=\"axis\" d=\"M{0:.1f} {1:.1f}H{2:.1f}M{3:.1f} {4:.1f}V{5:.1f}\"/>\n", x0_,
                                py(0), x1_, px(0), y0_, y1_);
        }
        if (x1_ < kWidth - 14) {
            out_ += fmt::format("<line class=\"axis\" x1=\"{0}\" x2=\"{0}\" y1=\"{1}\" y2=\"{2}\"/>"
                                "<text x=\"{3}\" y=\"{4}\" text-anchor=\"end\">{5}</text>\n",
                                x1_, y0_, y1_, kWidth - 14, kRow, escape_markup(f_.right_label));
        }
        std::string const time = f_.zero_name.empty() ? "time" : "time since " + f_.zero_name;
        out_ += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text><text x=\"{}\" y=\"{}\">{}</text>\n",
                            x1_, y0_ + kBottomMargin - 4,
                            f_.x_label.empty() ? escape_markup(time + ", " + unit_.name) : escape_markup(f_.x_label),
                            f_.lanes ? 8 : x0_ - 40, kRow, escape_markup(f_.y_label));
    }

    Figure const& f_;
    TimeUnit unit_;
    AxisRange left_, right_;
    double x0_{62}, x1_{0}, y0_{0}, y1_{0}, marks_top_{0};
    std::vector<Row> rows_;
    std::string legend_, out_;
};

} // namespace

std::string to_svg(Figure const& figure) {
    return Drawing{figure}.svg();
}

} // namespace gridspace::launcher

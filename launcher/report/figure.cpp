// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/figure.hpp"

#include "common/csv_field.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <set>

namespace gridspace::launcher {
namespace {

// Okabe and Ito.
constexpr std::array<std::string_view, 8> kPalette{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                   "#E69F00", "#56B4E9", "#6A51A3", "#7F7F7F"};
constexpr std::size_t kMaxPoints = 3000;
constexpr std::size_t kMostValues = 1'000'000; // of a series in a figure's table

} // namespace

bool Figure::interactive() const {
    return !log_x && x_names.empty() &&
           std::none_of(series.begin(), series.end(), [](auto const& s) { return s.path; });
}

std::string_view palette_colour(int wanted, std::size_t place) {
    return kPalette[(wanted >= 0 ? static_cast<std::size_t>(wanted) : place) % kPalette.size()];
}

namespace {

/// The first value that the window shows, and the one behind the last: what holds at its begin counts.
std::pair<std::size_t, std::size_t> shown(Figure::Series const& s, double from_s, double to_s) {
    std::size_t first = 0, last = s.values.size();
    while (first + 1 < last && static_cast<double>(s.times_ns[first + 1]) / 1e9 < from_s) {
        ++first;
    }
    while (last > first + 1 && static_cast<double>(s.times_ns[last - 1]) / 1e9 > to_s) {
        --last;
    }
    return {first, last};
}

/// Of those the ones that are drawn, in their order: the extremes of each bucket.
template <class Take>
void draw_from(Figure::Series const& s, std::size_t first, std::size_t last, Take const& take) {
    std::size_t const bucket = std::max<std::size_t>(1, (last - first) / (kMaxPoints / 2));
    std::size_t taken = first;
    for (std::size_t i = first; i < last; i += bucket) {
        std::size_t low = i, high = i;
        for (std::size_t k = i; k < std::min(last, i + bucket); ++k) {
            bool const nothing = std::isnan(s.values[k]); // an end, which is kept as the extremes are
            low = nothing || s.values[k] < s.values[low] ? k : low;
            high = !nothing && !(s.values[k] <= s.values[high]) ? k : high;
        }
        take(std::min(low, high));
        taken = std::max(low, high);
        if (low != high) {
            take(taken);
        }
    }
    if (first < last && s.times_ns[taken] < s.times_ns[last - 1]) {
        take(last - 1);
    }
}

} // namespace

std::vector<std::pair<double, double>> drawn_points(Figure::Series const& s, double from_s, double to_s) {
    std::vector<std::pair<double, double>> points;
    auto const point = [&](std::size_t i) {
        points.emplace_back(static_cast<double>(s.times_ns[i]) / 1e9, s.values[i]);
    };
    if (s.path) {
        for (std::size_t i = 0; i < s.values.size(); ++i) {
            point(i);
        }
        return points;
    }
    auto const [first, last] = shown(s, from_s, to_s);
    draw_from(s, first, last, point);
    return points;
}

void shorten(Figure::Series& s, double from_s, double to_s) {
    if (s.values.size() <= kMostValues) {
        return;
    }
    auto const [first, last] = shown(s, from_s, to_s);
    std::vector<std::int64_t> times_ns;
    std::vector<double> values;
    auto const keep = [&](std::size_t i) {
        times_ns.push_back(s.times_ns[i]);
        values.push_back(s.values[i]);
    };
    if (last - first > kMostValues) {
        draw_from(s, first, last, keep);
    } else {
        for (std::size_t i = first; i < last; ++i) {
            keep(i);
        }
    }
    s.times_ns = std::move(times_ns);
    s.values = std::move(values);
}

TimeUnit time_unit(double span_s) {
    return span_s > 7200  ? TimeUnit{"h", 3600}
           : span_s > 600 ? TimeUnit{"min", 60}
           : span_s < 0.5 ? TimeUnit{"ms", 1e-3}
                          : TimeUnit{"s", 1};
}

namespace {

std::string paths_csv(Figure const& f) {
    std::string out = "series,x,value\n";
    for (Figure::Series const& s : f.series) {
        for (std::size_t i = 0; i < s.values.size() && !s.name.empty(); ++i) {
            if (!std::isfinite(s.values[i])) { // the path goes on elsewhere
                continue;
            }
            out += fmt::format("{},{},{}\n", csv_field(s.name), shortest(static_cast<double>(s.times_ns[i]) / 1e9),
                               shortest(s.values[i]));
        }
    }
    return out;
}

} // namespace

std::string to_csv(Figure const& f) {
    if (std::any_of(f.series.begin(), f.series.end(), [](auto const& s) { return s.path; })) {
        return paths_csv(f);
    }
    std::string out = f.x_label.empty() ? "time_s" : "x";
    std::set<std::int64_t> times;
    for (Figure::Series const& s : f.series) {
        out += "," + csv_field(s.name);
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
            bool const has_value = next[i] > 0 && !std::isnan(s.values[next[i] - 1]);
            out += has_value ? "," + shortest(s.values[next[i] - 1]) : ",";
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
                           script_text(f.series[i].name), palette_colour(f.series[i].colour, i), times, values);
    }
    return out + "]}";
}

} // namespace gridspace::launcher

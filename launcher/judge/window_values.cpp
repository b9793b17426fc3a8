// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/window_values.hpp"

#include "common/nearest_rank.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <vector>

namespace gridspace::launcher {
namespace {

using Verb = Expectation::Verb;

/// All values in the window: of every signal of a pattern, or of the expression.
std::vector<double> collect(Expectation const& e, Timeline const& timeline) {
    std::vector<double> out;
    if (e.expression->is_plain_signal()) {
        for (SignalSeries const* series : timeline.series()) {
            for (std::size_t i = 0; i < series->times_ns.size(); ++i) {
                bool const held_at_begin =
                    i + 1 < series->times_ns.size() ? series->times_ns[i + 1] > timeline.from() : true;
                if (series->times_ns[i] <= timeline.until() &&
                    (series->times_ns[i] >= timeline.from() || held_at_begin)) {
                    out.push_back(series->values[i]);
                }
            }
        }
    } else {
        timeline.run([&](std::int64_t, double value) {
            out.push_back(value);
            return true;
        });
    }
    return out;
}

} // namespace

std::string seconds_text(std::int64_t ns) {
    return shortest(static_cast<double>(ns) / 1e9);
}

std::optional<double> statistic(Expectation const& e, Timeline const& timeline) {
    std::vector<double> values = collect(e, timeline);
    if (values.empty()) {
        return std::nullopt;
    }
    if (e.verb != Verb::last_of) { // there is no least and no mean of what has no value
        auto const undefined =
            std::find_if_not(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
        if (undefined != values.end()) {
            return *undefined;
        }
    }
    switch (e.verb) {
    case Verb::min_of:
        return *std::min_element(values.begin(), values.end());
    case Verb::max_of:
        return *std::max_element(values.begin(), values.end());
    case Verb::mean_of: {
        double sum = 0;
        for (double const v : values) {
            sum += v;
        }
        return sum / static_cast<double>(values.size());
    }
    case Verb::median_of:
        std::ranges::sort(values);
        return nearest_rank(values, 0.5);
    case Verb::p99_of:
        std::ranges::sort(values);
        return nearest_rank(values, 0.99);
    default: {
        // last_of: with a pattern, the worst last value is what matters; the largest is shown.
        if (!e.expression->is_plain_signal()) {
            return values.back();
        }
        std::optional<double> last;
        for (SignalSeries const* series : timeline.series()) {
            auto const end = std::upper_bound(series->times_ns.begin(), series->times_ns.end(), timeline.until());
            if (end != series->times_ns.begin()) {
                double const v = series->values[static_cast<std::size_t>(end - series->times_ns.begin()) - 1];
                last = last ? std::max(*last, v) : v;
            }
        }
        return last;
    }
    }
}

std::string clocks_apart(SignalStore const& signals, Expression const& expression, Timeline const& timeline) {
    constexpr double kNanosecondMs = 1e-6; // what the arithmetic of doubles may lose
    for (auto const& [name, series] : signals) {
        bool const used = is_wall_clock_signal(name) && name.ends_with("_ms") &&
                          std::any_of(expression.signals().begin(), expression.signals().end(),
                                      [&](std::string const& pattern) { return matches_glob(pattern, name); });
        for (std::size_t i = 0; used && i < series.values.size(); ++i) {
            bool const within = series.times_ns[i] >= timeline.from() && series.times_ns[i] <= timeline.until();
            if (within && series.values[i] < -kNanosecondMs) {
                return fmt::format(
                    "not measurable: {} is below 0 ({} ms) at {} s, so the clocks of its two ends are not one", name,
                    shortest(series.values[i]), seconds_text(series.times_ns[i]));
            }
        }
    }
    return {};
}

Edges edges_of(Timeline const& timeline) {
    Edges edges;
    bool before = false;
    timeline.run([&](std::int64_t, double value) {
        bool const now = is_true(value);
        edges.true_samples += now ? 1 : 0;
        edges.rises += edges.any && now && !before ? 1 : 0;
        edges.falls += edges.any && !now && before ? 1 : 0;
        edges.any = true;
        before = now;
        return true;
    });
    return edges;
}

Fulfilment fulfilment_of(Timeline const& timeline, Expression::Edge edge, std::int64_t begin) {
    Fulfilment out;
    bool known = false, before = false;
    timeline.run([&](std::int64_t t, double value) {
        bool const now = is_true(value) != (edge == Expression::Edge::falls);
        bool const becomes = now && (known ? !before : edge == Expression::Edge::none);
        known = true;
        before = now;
        if (t < begin) {
            out.true_since = becomes ? std::optional{t} : now ? out.true_since : std::nullopt;
        } else if (becomes) {
            out.at = t;
        }
        return !out.at && !(t >= begin && out.true_since && edge == Expression::Edge::none);
    });
    return out;
}

} // namespace gridspace::launcher

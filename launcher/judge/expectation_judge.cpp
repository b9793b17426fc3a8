// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/nearest_rank.hpp"
#include "common/text.hpp"
#include "launcher/judge/expectation.hpp"
#include "launcher/judge/timeline.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace gridspace::launcher {
namespace {

using Status = ExpectationResult::Status;
using Verb = Expectation::Verb;

constexpr char const* kUndefined = "without a value (a division by zero)";

std::int64_t nanoseconds(double seconds) {
    return std::llround(seconds * 1e9);
}

std::string seconds_text(std::int64_t ns) {
    return shortest(static_cast<double>(ns) / 1e9);
}

/// How far the recording goes: the clock as it was last seen, or what was recorded after that.
std::int64_t end_of(SignalStore const& signals, double duration_s) {
    std::int64_t end = nanoseconds(duration_s);
    for (auto const& [name, series] : signals) {
        end = series.times_ns.empty() ? end : std::max(end, series.times_ns.back());
    }
    return end;
}

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

/// Where a delay in the window is below zero, and what that says: nothing arrives before it was sent. Empty: nowhere.
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

bool is_true(double value) {
    return value != 0 && !std::isnan(value);
}

/// How often the expression becomes true and false, and at how many samples it is true.
struct Edges {
    bool any{false}; ///< the expression has a value in the window
    std::int64_t rises{0}, falls{0}, true_samples{0};
};

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

/// When a condition becomes what is waited for.
struct Fulfilment {
    std::optional<std::int64_t> at;         ///< the first time at or after the begin
    std::optional<std::int64_t> true_since; ///< it was so before the begin already, from here on
};

/// `timeline` starts before `begin`, so that what becomes true at `begin` is told from what was true before. With
/// `rises` and `falls` the next edge counts; without, a condition whose first value is true has become so with that
/// value.
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

void judge_condition(Expectation const& e, Timeline const& timeline, ExpectationResult& out) {
    bool const wanted = e.verb != Verb::never;
    std::optional<std::int64_t> decisive, undefined;
    bool any = false;
    timeline.run([&](std::int64_t t, double value) {
        any = true;
        bool const holds = is_true(value);
        if (std::isnan(value) && !undefined) {
            undefined = t;
        }
        if (e.verb == Verb::eventually ? holds : holds != wanted || std::isnan(value)) {
            decisive = t;
        }
        return !decisive;
    });
    bool const passed = any && (e.verb == Verb::eventually ? decisive.has_value() : !decisive.has_value());
    out.value = passed ? 1 : 0;
    out.status = passed ? Status::passed : Status::failed;
    if (decisive) {
        out.decided_at_s = static_cast<double>(*decisive) / 1e9;
    }
    if (!any) {
        out.detail = "the signals have no values in that time";
    } else if (undefined && !passed) {
        out.detail = fmt::format("{}{} at {} s", e.verb == Verb::eventually ? "never true in that time; " : "",
                                 kUndefined, seconds_text(*undefined));
    } else if (decisive) {
        out.detail = fmt::format("{} at {} s",
                                 e.verb == Verb::eventually ? "true"
                                 : e.verb == Verb::never    ? "true"
                                                            : "not true",
                                 seconds_text(*decisive));
    } else if (e.verb == Verb::eventually) {
        out.detail = "never true in that time";
    }
}

/// The intervals between the messages of a stream, from the first message of a new state at or after the window's
/// begin.
void judge_intervals(Expectation const& e, SignalStore const& signals, std::int64_t from, ExpectationResult& out) {
    auto const intervals = signals.find(e.stream + ".interval_ms"), numbers = signals.find(e.stream + ".sq_num");
    out.status = Status::failed;
    out.unit = "ms";
    if (intervals == signals.end() || numbers == signals.end()) {
        out.detail = fmt::format("no messages of '{}' were recorded", e.stream);
        return;
    }
    SignalSeries const& sq = numbers->second;
    std::size_t first = 0;
    while (first < sq.values.size() && (sq.times_ns[first] < from || sq.values[first] != 0)) {
        ++first;
    }
    std::string text;
    bool good = true;
    for (std::size_t i = 0; i < e.are.size(); ++i) {
        std::size_t const row = first + 1 + i;
        if (row >= intervals->second.values.size()) {
            out.detail = fmt::format("only {} of {} intervals: {}", i, e.are.size(), text);
            return;
        }
        double const value = intervals->second.values[row];
        text += fmt::format("{}{:.3g}", text.empty() ? "" : ", ", value);
        good = good && std::abs(value - e.are[i]) <= e.tolerance.value_or(0);
    }
    out.detail = text + " ms";
    out.status = good ? Status::passed : Status::failed;
}

} // namespace

bool Expectation::Band::contains(double v) const {
    bool const above_low = !low || (low_open ? v > *low : v >= *low);
    bool const below_high = !high || (high_open ? v < *high : v <= *high);
    return above_low && below_high; // NaN is in no band
}

std::string Expectation::Band::to_string() const {
    if (low && high) {
        return *low == *high ? shortest(*low) : fmt::format("{} .. {}", shortest(*low), shortest(*high));
    }
    if (low) {
        return fmt::format("{} {}", low_open ? ">" : ">=", shortest(*low));
    }
    return high ? fmt::format("{} {}", high_open ? "<" : "<=", shortest(*high)) : "";
}

double Expectation::unit_s() const {
    return unit == "h" ? 3600 : unit == "min" ? 60 : unit == "ms" ? 1e-3 : 1;
}

Expectation::Band Expectation::band() const {
    Band b;
    if (is) {
        // 4.2 - 0.1 is 4.1000000000000005; what the user meant has few digits.
        auto const tidy = [](double v) { return std::round(v * 1e12) / 1e12; };
        b.low = tidy(*is - tolerance.value_or(0));
        b.high = tidy(*is + tolerance.value_or(0));
    }
    if (between.size() == 2) {
        b.low = between[0];
        b.high = between[1];
    }
    if (at_least) {
        b.low = *at_least;
    }
    if (at_most) {
        b.high = *at_most;
    }
    if (above) {
        b.low = *above;
        b.low_open = true;
    }
    if (below) {
        b.high = *below;
        b.high_open = true;
    }
    return b;
}

ExpectationResult judge(Expectation const& e, SignalStore const& signals, Moments const& moments, double duration_s,
                        bool lockstep) {
    ExpectationResult out;
    out.name = e.name.name;
    out.verb = e.verb_name;
    out.of = e.expression->text();
    out.band = e.band();
    out.advisory = e.advisory;
    out.unit = e.unit;
    std::vector<std::string> const& used = e.expression->signals();
    if (lockstep &&
        std::any_of(used.begin(), used.end(), [](std::string const& name) { return is_wall_clock_signal(name); })) {
        out.status = Status::not_applicable;
        out.detail = "of the wall clock: says nothing in lockstep";
        return out;
    }
    auto const missed = [&](std::string why) {
        out.detail = std::move(why);
        out.status = e.show_only ? Status::shown : Status::failed;
        return out;
    };
    auto const instant = [&](std::optional<Moment> const& moment, double otherwise) -> std::optional<double> {
        if (!moment) {
            return otherwise;
        }
        return instant_of(*moment, moments);
    };
    auto const from = instant(e.from, 0), until = instant(e.until, duration_s), since = instant(e.since, 0);
    for (auto const& [at, moment] : {std::pair{from, e.from}, {until, e.until}, {since, e.since}}) {
        if (!at) {
            return missed(fmt::format("'{}' did not happen", moment->event));
        }
    }
    std::int64_t const recorded_until = end_of(signals, duration_s);
    for (auto const& [at, moment] : {std::pair{from, e.from}, {since, e.since}}) {
        if (nanoseconds(*at) > recorded_until) { // the timeline names instants that a run may not come to
            return missed(
                fmt::format("the run ended at {} s, before '{}'", seconds_text(recorded_until), to_text(*moment)));
        }
    }
    if (e.until && nanoseconds(*until) < nanoseconds(*from)) {
        return missed(fmt::format("'{}' is at {} s, before '{}'", to_text(*e.until), shortest(*until),
                                  e.from ? to_text(*e.from) : "the start"));
    }
    if (e.verb == Verb::intervals_ms) {
        judge_intervals(e, signals, nanoseconds(*from), out);
        out.status = e.show_only ? Status::shown : out.status;
        return out;
    }
    double end = *until;
    if (e.within_s) {
        end = std::min(end, *from + *e.within_s);
    }
    // A time is looked for from `since` on, or it would be met by what was there before; a band that begins below zero
    // asks for that.
    bool const before_too = out.band.low && *out.band.low < 0;
    bool const is_time = e.verb == Verb::time_of;
    std::int64_t const begin = nanoseconds(is_time && !e.from && !before_too ? *since : *from);
    Timeline const timeline{*e.expression, signals, is_time ? 0 : begin, nanoseconds(end)};
    if (!timeline.missing().empty()) {
        return missed(fmt::format("no signal '{}' was recorded", timeline.missing()));
    }
    if (out.unit.empty() && e.expression->is_plain_signal() && !timeline.series().empty()) {
        out.unit = timeline.series().front()->unit;
    }
    bool const asks_when = is_time || e.verb == Verb::count_of || e.verb == Verb::eventually;
    if (std::string why = clocks_apart(signals, *e.expression, timeline); !asks_when && !before_too && !why.empty()) {
        return missed(std::move(why));
    }
    switch (e.verb) {
    case Verb::always:
    case Verb::never:
    case Verb::eventually:
        judge_condition(e, timeline, out);
        if (e.show_only) {
            out.status = Status::shown;
        }
        return out;
    case Verb::count_of: {
        Edges const edges = edges_of(timeline);
        out.unit.clear();
        if (!edges.any) {
            return missed("no values in that time");
        }
        out.value = static_cast<double>(e.expression->edge() == Expression::Edge::rises   ? edges.rises
                                        : e.expression->edge() == Expression::Edge::falls ? edges.falls
                                                                                          : edges.true_samples);
        break;
    }
    case Verb::time_of: {
        auto [at, true_since] = fulfilment_of(timeline, e.expression->edge(), begin);
        if (!at && true_since && e.since) { // no answer to it
            return missed(fmt::format("was already {} at {} s, before '{}'",
                                      e.expression->edge() == Expression::Edge::falls ? "false" : "true",
                                      seconds_text(*true_since), to_text(e.from ? *e.from : *e.since)));
        }
        if (!at && true_since &&
            e.expression->edge() == Expression::Edge::none) { // no event is asked about: `from` is the first time
            at = begin;
        }
        if (!at) {
            return missed("it never became true");
        }
        if (e.since && !before_too && *at < nanoseconds(*since)) {
            return missed(fmt::format("became true at {} s, before '{}'", seconds_text(*at), to_text(*e.since)));
        }
        out.value = (static_cast<double>(*at) / 1e9 - *since) / e.unit_s();
        break;
    }
    default:
        out.value = statistic(e, timeline);
        if (!out.value) {
            return missed("no values in that time");
        }
    }
    if (!std::isfinite(*out.value)) {
        out.value.reset();
        return missed(kUndefined);
    }
    out.status = e.show_only ? Status::shown : out.band.contains(*out.value) ? Status::passed : Status::failed;
    return out;
}

} // namespace gridspace::launcher

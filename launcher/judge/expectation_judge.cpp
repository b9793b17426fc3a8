// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "launcher/judge/expectation.hpp"
#include "launcher/judge/timeline.hpp"
#include "launcher/judge/window_values.hpp"

#include <algorithm>
#include <cmath>
#include <expected>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using Status = ExpectationResult::Status;
using Verb = Expectation::Verb;

constexpr char const* kUndefined = "without a value (a division by zero)";

std::int64_t nanoseconds(double seconds) {
    return std::llround(seconds * 1e9);
}

/// How far the recording goes: the clock as it was last seen, or what was recorded after that.
std::int64_t end_of(SignalStore const& signals, double duration_s) {
    std::int64_t end = nanoseconds(duration_s);
    for (auto const& [name, series] : signals) {
        end = series.times_ns.empty() ? end : std::max(end, series.times_ns.back());
    }
    return end;
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

ExpectationResult not_judged_yet(Expectation const& e) {
    ExpectationResult out;
    out.name = e.name.name;
    out.verb = e.verb_name;
    out.of = e.expression->text();
    out.band = e.band();
    out.advisory = e.advisory;
    out.unit = e.unit;
    return out;
}

bool is_of_wall_clock(Expression const& expression) {
    std::vector<std::string> const& used = expression.signals();
    return std::any_of(used.begin(), used.end(), [](std::string const& name) { return is_wall_clock_signal(name); });
}

/// In seconds of simulated time.
struct Instants {
    double from{0}, until{0}, since{0};
};

/// Those that the expectation names; or why there is nothing to judge.
std::expected<Instants, std::string> instants_of(Expectation const& e, SignalStore const& signals,
                                                 Moments const& moments, double duration_s) {
    auto const instant = [&](std::optional<Moment> const& moment, double otherwise) -> std::optional<double> {
        if (!moment) {
            return otherwise;
        }
        return instant_of(*moment, moments);
    };
    auto const from = instant(e.from, 0), until = instant(e.until, duration_s), since = instant(e.since, 0);
    for (auto const& [at, moment] : {std::pair{from, e.from}, {until, e.until}, {since, e.since}}) {
        if (!at) {
            return std::unexpected{fmt::format("'{}' did not happen", moment->event)};
        }
    }
    std::int64_t const recorded_until = end_of(signals, duration_s);
    for (auto const& [at, moment] : {std::pair{from, e.from}, {since, e.since}}) {
        if (nanoseconds(*at) > recorded_until) { // the timeline names instants that a run may not come to
            return std::unexpected{
                fmt::format("the run ended at {} s, before '{}'", seconds_text(recorded_until), to_text(*moment))};
        }
    }
    if (e.until && nanoseconds(*until) < nanoseconds(*from)) {
        return std::unexpected{fmt::format("'{}' is at {} s, before '{}'", to_text(*e.until), shortest(*until),
                                           e.from ? to_text(*e.from) : "the start")};
    }
    return Instants{*from, *until, *since};
}

std::expected<double, std::string> count_of(Expression const& expression, Timeline const& timeline) {
    Edges const edges = edges_of(timeline);
    if (!edges.any) {
        return std::unexpected{"no values in that time"};
    }
    return static_cast<double>(expression.edge() == Expression::Edge::rises   ? edges.rises
                               : expression.edge() == Expression::Edge::falls ? edges.falls
                                                                              : edges.true_samples);
}

/// From `since_s`, in the unit of the expectation. `before_too`: what happens before that is an answer as well.
std::expected<double, std::string> time_of(Expectation const& e, Timeline const& timeline, std::int64_t begin,
                                           double since_s, bool before_too) {
    Expression::Edge const edge = e.expression->edge();
    auto [at, true_since] = fulfilment_of(timeline, edge, begin);
    if (!at && true_since && e.since) { // no answer to it
        return std::unexpected{fmt::format("was already {} at {} s, before '{}'",
                                           edge == Expression::Edge::falls ? "false" : "true",
                                           seconds_text(*true_since), to_text(e.from ? *e.from : *e.since))};
    }
    if (!at && true_since && edge == Expression::Edge::none) { // no event is asked about: `from` is the first time
        at = begin;
    }
    if (!at) {
        return std::unexpected{"it never became true"};
    }
    if (e.since && !before_too && *at < nanoseconds(since_s)) {
        return std::unexpected{fmt::format("became true at {} s, before '{}'", seconds_text(*at), to_text(*e.since))};
    }
    return (static_cast<double>(*at) / 1e9 - since_s) / e.unit_s();
}

std::expected<double, std::string> statistic_of(Expectation const& e, Timeline const& timeline) {
    auto const value = statistic(e, timeline);
    if (!value) {
        return std::unexpected{"no values in that time"};
    }
    return *value;
}

} // namespace

ExpectationResult judge(Expectation const& e, SignalStore const& signals, Moments const& moments, double duration_s,
                        bool lockstep) {
    ExpectationResult out = not_judged_yet(e);
    if (lockstep && is_of_wall_clock(*e.expression)) {
        out.status = Status::not_applicable;
        out.detail = "of the wall clock: says nothing in lockstep";
        return out;
    }
    auto const missed = [&](std::string why) {
        out.detail = std::move(why);
        out.status = e.show_only ? Status::shown : Status::failed;
        return out;
    };
    auto const instants = instants_of(e, signals, moments, duration_s);
    if (!instants) {
        return missed(instants.error());
    }
    if (e.verb == Verb::intervals_ms) {
        judge_intervals(e, signals, nanoseconds(instants->from), out);
        out.status = e.show_only ? Status::shown : out.status;
        return out;
    }
    double const end = e.within_s ? std::min(instants->until, instants->from + *e.within_s) : instants->until;
    // A time is looked for from `since` on, or it would be met by what was there before; a band that begins below zero
    // asks for that.
    bool const before_too = out.band.low && *out.band.low < 0;
    bool const is_time = e.verb == Verb::time_of;
    std::int64_t const begin = nanoseconds(is_time && !e.from && !before_too ? instants->since : instants->from);
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
    if (e.verb == Verb::always || e.verb == Verb::never || e.verb == Verb::eventually) {
        judge_condition(e, timeline, out);
        out.status = e.show_only ? Status::shown : out.status;
        return out;
    }
    if (e.verb == Verb::count_of) {
        out.unit.clear();
    }
    auto const value = e.verb == Verb::count_of ? count_of(*e.expression, timeline)
                       : is_time                ? time_of(e, timeline, begin, instants->since, before_too)
                                                : statistic_of(e, timeline);
    if (!value) {
        return missed(value.error());
    }
    if (!std::isfinite(*value)) {
        return missed(kUndefined);
    }
    out.value = *value;
    out.status = e.show_only ? Status::shown : out.band.contains(*out.value) ? Status::passed : Status::failed;
    return out;
}

} // namespace gridspace::launcher

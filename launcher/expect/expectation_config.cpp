// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "launcher/expect/expectation.hpp"
#include "launcher/scenario/scenario.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;
using Verb = Expectation::Verb;

constexpr std::array<std::pair<std::string_view, Verb>, 12> kVerbs{{{"always", Verb::always},
                                                                    {"never", Verb::never},
                                                                    {"eventually", Verb::eventually},
                                                                    {"time_of", Verb::time_of},
                                                                    {"min_of", Verb::min_of},
                                                                    {"max_of", Verb::max_of},
                                                                    {"mean_of", Verb::mean_of},
                                                                    {"median_of", Verb::median_of},
                                                                    {"p99_of", Verb::p99_of},
                                                                    {"count_of", Verb::count_of},
                                                                    {"last_of", Verb::last_of},
                                                                    {"intervals_ms", Verb::intervals_ms}}};

std::optional<Moment> parse_moment(std::string_view text) {
    Moment moment;
    std::size_t const sign = text.find_first_of("+-");
    moment.event = std::string{trim(text.substr(0, sign))};
    if (sign != std::string_view::npos) {
        std::string_view rest = trim(text.substr(sign + 1));
        auto const [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), moment.offset_s);
        std::string_view const unit = trim(rest.substr(static_cast<std::size_t>(end - rest.data())));
        double const factor = unit == "s" ? 1 : unit == "ms" ? 1e-3 : unit == "min" ? 60 : unit == "h" ? 3600 : 0;
        if (error != std::errc{} || factor == 0) {
            return std::nullopt;
        }
        moment.offset_s *= text[sign] == '-' ? -factor : factor;
    }
    return moment.event.empty() ? std::nullopt : std::optional{moment};
}

void moment(Fields& f, std::string_view key, std::optional<Moment>& out, std::string_view doc) {
    std::string text;
    f.text(key, text, {.doc = doc});
    if (!text.empty()) {
        out = parse_moment(text);
        if (!out) {
            f.error(key, fmt::format("'{}' is not an instant", text),
                    "an event, with `+` or `-` and a time: fault + 2 s");
        }
    }
}

/// Bounds that exclude each other. `between` is judged on its own.
bool nothing_lies_within(Expectation const& e) {
    double const lower = std::max(e.above.value_or(-INFINITY), e.at_least.value_or(-INFINITY));
    double const upper = std::min(e.below.value_or(INFINITY), e.at_most.value_or(INFINITY));
    return lower > upper || (lower == upper && (e.above == lower || e.below == upper));
}

void describe(Fields& f, Expectation& e) {
    int verbs = 0;
    for (auto const& [name, verb] : kVerbs) {
        std::string text;
        f.text(name, text, {});
        if (text.empty()) {
            continue;
        }
        ++verbs;
        e.verb = verb;
        e.verb_name = name;
        if (verb == Verb::intervals_ms) { // judged by the rows of the stream, not by a value
            e.stream = text;
            text += ".interval_ms";
        }
        auto expression = Expression::parse(text);
        if (expression) {
            e.expression = std::move(*expression);
        } else {
            f.error(name, expression.error().message);
        }
    }
    f.number("is", e.is, {.doc = "wanted value"});
    f.number("tolerance", e.tolerance, {.doc = "of `is`, to both sides", .min = 0});
    f.number("above", e.above, {.doc = "lower bound, not included"});
    f.number("below", e.below, {.doc = "upper bound, not included"});
    f.number("at_least", e.at_least, {.doc = "lower bound"});
    f.number("at_most", e.at_most, {.doc = "upper bound"});
    f.numbers("between", e.between, {.doc = "lower and upper bound"});
    f.numbers("are", e.are, {.doc = "intervals_ms: the wanted intervals from the first message of a new state on"});
    f.text("unit", e.unit, {.doc = "of a time: h, min, s or ms"});
    std::optional<double> within_ms;
    f.number("within_s", e.within_s, {.doc = "how soon after `from`", .above = 0});
    f.number("within_ms", within_ms, {.doc = "how soon after `from`", .above = 0});
    if (within_ms) {
        e.within_s = *within_ms / 1e3;
    }
    moment(f, "from", e.from, "begin of the judged time");
    moment(f, "until", e.until, "end of the judged time");
    moment(f, "since", e.since, "a time counts from here");
    f.flag("show_only", e.show_only, {.doc = "reported, not judged"});
    std::string timing;
    f.text("timing", timing, {.doc = "advisory: a failure is shown, and the run still passes"});
    e.advisory = timing == "advisory";
    if (!timing.empty() && timing != "advisory") {
        f.error("timing", fmt::format("'{}' is not understood", timing), "expected advisory");
    }
    if (verbs != 1) {
        std::vector<std::string> names;
        for (auto const& verb : kVerbs) {
            names.emplace_back(verb.first);
        }
        f.error("",
                fmt::format("expectation '{}' has {}", e.name.name,
                            verbs == 0 ? "no verb" : fmt::format("{} verbs", verbs)),
                "exactly one of: " + join(names, ", "));
        return;
    }
    if ((e.verb == Verb::intervals_ms) == e.are.empty()) {
        f.error("are", fmt::format("expectation '{}': `intervals_ms` and `are` go together", e.name.name),
                "intervals_ms: stream.TRIP2, from: relay.trip, are: [1, 2, 4], tolerance: 0.5");
        return;
    }
    bool const numeric =
        e.verb != Verb::intervals_ms && e.verb != Verb::always && e.verb != Verb::never && e.verb != Verb::eventually;
    bool const bounded = e.is || e.above || e.below || e.at_least || e.at_most || !e.between.empty();
    if (numeric && !bounded && !e.show_only) {
        f.error("", fmt::format("expectation '{}' says nothing about the value", e.name.name),
                "is (with tolerance), above, below, at_least, at_most or between; or show_only: true");
    }
    if (!numeric && bounded) {
        f.error("", fmt::format("expectation '{}' is true or false, and has a band", e.name.name));
    }
    if (!e.between.empty() && (e.between.size() != 2 || e.between[0] > e.between[1])) {
        f.error("between", fmt::format("expectation '{}' needs two bounds, the lower first", e.name.name));
    }
    if (nothing_lies_within(e)) {
        f.error("", fmt::format("expectation '{}' has bounds that no value lies within", e.name.name),
                "the lower bound (above, at_least) belongs below the upper one (below, at_most)");
    }
    bool const is_time = e.verb == Verb::time_of;
    if (is_time && e.unit.empty()) {
        e.unit = "s";
    }
    if (is_time && e.unit != "h" && e.unit != "min" && e.unit != "s" && e.unit != "ms") {
        f.error("unit", fmt::format("'{}' is not a unit of time", e.unit), "h, min, s or ms");
    }
    if (e.expression && e.expression->edge() != Expression::Edge::none && e.verb != Verb::count_of &&
        e.verb != Verb::time_of) {
        f.error("", fmt::format("expectation '{}': `rises` and `falls` go with count_of and time_of", e.name.name));
    }
}

/// What makes the run record samples at all; empty when it does.
std::string to_be_recorded(Scenario const& scenario) {
    bool const recorder = std::any_of(scenario.processes.begin(), scenario.processes.end(),
                                      [](Process const& p) { return p.program.name == "gridspace-recorder"; });
    return !recorder                  ? "a process with `program: gridspace-recorder` records it"
           : !scenario.record.samples ? "`record: {samples: all}` records it"
                                      : "";
}

/// Whether the report will know a signal. record.signals is about the simulator's; how long a detector takes is in a
/// file of its own.
bool is_recorded(Scenario const& scenario, Process const& process, std::string const& signal, bool samples) {
    if (matches_glob("ids.*.time_us_*", signal)) {
        return true;
    }
    std::vector<std::string> const& wanted = scenario.record.signals;
    return samples &&
           (&process != scenario.simulator() ||
            std::any_of(wanted.begin(), wanted.end(), [&](std::string const& p) { return matches_glob(p, signal); }));
}

} // namespace

std::vector<Expectation> read_expectations(Node const& node, Diagnostics& diagnostics) {
    std::vector<Expectation> out;
    if (node.is_null()) {
        return out;
    }
    Node wrapper = Node::map(node.where);
    wrapper.set("expect", node);
    config::read_fields(wrapper, "", diagnostics, [&](Fields& f) {
        f.map("expect", {}, [&](Ref const& name, Fields& e) {
            Expectation expectation;
            expectation.name = name;
            describe(e, expectation);
            out.push_back(std::move(expectation));
        });
    });
    return out;
}

void check_expectations(Scenario const& scenario, Diagnostics& diagnostics) {
    std::vector<Expectation> const expectations = read_expectations(scenario.expect, diagnostics);
    std::vector<std::string> signals, recorded;
    std::string const remedy = to_be_recorded(scenario);
    for (Process const& process : scenario.processes) {
        for (SignalUse& signal : process.settings->signals(scenario, process)) {
            if (is_recorded(scenario, process, signal.name, remedy.empty())) {
                recorded.push_back(signal.name);
            }
            signals.push_back(std::move(signal.name));
        }
    }
    std::vector<std::string> events;
    for (sim::Event const& event : scenario.events) {
        events.push_back(event.name.name);
    }
    for (Expectation const& e : expectations) {
        if (!e.expression) {
            continue; // said already
        }
        config::Node const* settings = scenario.expect.find(e.name.name);
        config::Node const* written = settings == nullptr ? nullptr : settings->find(e.verb_name);
        config::SourceMark const where = written == nullptr ? e.name.where : written->where;
        auto const width = static_cast<int>(written == nullptr ? e.name.name.size() : written->text.size());
        for (std::string const& pattern : e.expression->signals()) {
            auto const among = [&](std::vector<std::string> const& names) {
                return std::any_of(names.begin(), names.end(),
                                   [&](std::string const& s) { return matches_glob(pattern, s); });
            };
            if (!among(signals)) {
                diagnostics.error(
                    where,
                    fmt::format("expectation '{}' uses the signal '{}', which does not exist", e.name.name, pattern),
                    did_you_mean(pattern, signals, "`gridspace signals` lists them"), width);
            } else if (!among(recorded)) {
                std::string const what =
                    fmt::format("expectation '{}' uses the signal '{}', which is not recorded", e.name.name, pattern);
                std::string const help = remedy.empty() ? fmt::format("add \"{}\" to record.signals", pattern) : remedy;
                e.show_only ? diagnostics.warning(where, what, help, width)
                            : diagnostics.error(where, what, help, width);
            }
        }
        for (std::optional<Moment> const* moment : {&e.from, &e.until, &e.since}) {
            if (*moment && (*moment)->event.find('.') == std::string::npos &&
                std::find(events.begin(), events.end(), (*moment)->event) == events.end()) {
                diagnostics.error(e.name.where,
                                  fmt::format("expectation '{}' refers to the event '{}', which does not exist",
                                              e.name.name, (*moment)->event),
                                  did_you_mean((*moment)->event, events), static_cast<int>(e.name.name.size()));
            }
        }
    }
}

} // namespace gridspace::launcher

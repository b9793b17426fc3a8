// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "launcher/judge/expectation.hpp"

#include <algorithm>
#include <array>
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

/// Bounds that exclude each other. `between` is judged on its own.
bool nothing_lies_within(Expectation const& e) {
    double const lower = std::max(e.above.value_or(-INFINITY), e.at_least.value_or(-INFINITY));
    double const upper = std::min(e.below.value_or(INFINITY), e.at_most.value_or(INFINITY));
    return lower > upper || (lower == upper && (e.above == lower || e.below == upper));
}

/// How many verbs are given; the last one counts.
int describe_verb(Fields& f, Expectation& e) {
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
    return verbs;
}

void describe_band(Fields& f, Expectation& e) {
    f.number("is", e.is, {.doc = "wanted value"});
    f.number("tolerance", e.tolerance, {.doc = "of `is`, to both sides", .min = 0});
    f.number("above", e.above, {.doc = "lower bound, not included"});
    f.number("below", e.below, {.doc = "upper bound, not included"});
    f.number("at_least", e.at_least, {.doc = "lower bound"});
    f.number("at_most", e.at_most, {.doc = "upper bound"});
    f.numbers("between", e.between, {.doc = "lower and upper bound"});
    f.numbers("are", e.are, {.doc = "intervals_ms: the wanted intervals from the first message of a new state on"});
    f.text("unit", e.unit, {.doc = "of a time: h, min, s or ms"});
}

void describe_judged_time(Fields& f, Expectation& e) {
    std::optional<double> within_ms;
    f.number("within_s", e.within_s, {.doc = "how soon after `from`", .above = 0});
    f.number("within_ms", within_ms, {.doc = "how soon after `from`", .above = 0});
    if (within_ms) {
        e.within_s = *within_ms / 1e3;
    }
    describe_moment(f, "from", e.from, "begin of the judged time");
    describe_moment(f, "until", e.until, "end of the judged time");
    describe_moment(f, "since", e.since, "a time counts from here");
}

void describe_weight(Fields& f, Expectation& e) {
    f.flag("show_only", e.show_only, {.doc = "reported, not judged"});
    std::string timing;
    f.text("timing", timing, {.doc = "advisory: a failure is shown, and the run still passes"});
    e.advisory = timing == "advisory";
    if (!timing.empty() && timing != "advisory") {
        f.error("timing", fmt::format("'{}' is not understood", timing), "expected advisory");
    }
}

/// A verb about a value needs bounds that something lies within, others have none.
void check_band(Fields& f, Expectation const& e) {
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
}

void describe(Fields& f, Expectation& e) {
    int const verbs = describe_verb(f, e);
    describe_band(f, e);
    describe_judged_time(f, e);
    describe_weight(f, e);
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
    check_band(f, e);
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

} // namespace gridspace::launcher

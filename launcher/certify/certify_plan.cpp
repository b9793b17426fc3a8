// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/merge.hpp"
#include "common/text.hpp"
#include "launcher/certify/binomial_interval.hpp"
#include "launcher/certify/certify_case.hpp"
#include "launcher/scenario/scenario.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <tuple>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Node;

constexpr std::int64_t kUsualSamples = 10;

Node text(std::string value) {
    return Node::quoted_text(std::move(value));
}

/// What the case says, with its place in the file: mistakes in it are shown there.
Node text(Ref const& said) {
    return Node::quoted_text(said.name, said.where);
}

Node merged(Node base, Node const& over) {
    if (base.is_null()) {
        return over;
    }
    if (!over.is_null()) { // as an overlay, nothing would take everything away
        config::merge(base, over);
    }
    return base;
}

Node results_of(CertifyCase const& all, FaultGroup const& group) {
    Node out = Node::map(all.trip.where);
    if (!group.must_trip) {
        out.set(kStayed, Node::map(all.trip.where)).set("never", text(all.trip));
        return out;
    }
    Node& time = out.set(kTripMs, Node::map(all.trip.where));
    time.set("time_of", text(all.trip));
    time.set("since", text(all.fault));
    time.set("unit", text("ms"));
    Node& tripped = out.set(kTripped, Node::map(all.trip.where));
    tripped.set("eventually", text(all.trip));
    tripped.set("from", text(all.fault));
    tripped.set("within_ms", Node::scalar(shortest(group.within_ms)));
    Node& before = out.set(kQuietBefore, Node::map(all.trip.where));
    before.set("never", text(all.trip));
    before.set("until", text(all.fault));
    return out;
}

/// A bound that not even a relay without a fault could show with so few.
void check_bound(std::optional<double> const& bound, config::SourceMark const& where, std::size_t runs,
                 double confidence, Diagnostics& diagnostics) {
    double const best = clopper_pearson(runs, runs, confidence).low;
    if (!bound || best >= *bound) {
        return;
    }
    double const needed = std::ceil(std::log((1 - confidence) / 2) / std::log(*bound));
    diagnostics.error(
        where,
        fmt::format("so few faults cannot show that: with {0} of {0} right the lower end is {1:.4f}", runs, best),
        *bound < 1 ? fmt::format("{:.0f} faults can, with more `samples`", needed)
                   : "no number of faults shows 1; ask for less");
}

/// A disturbance record around the fault of each run, unless the case has settings of its own for that.
void with_comtrade(Node& root, CertifyCase const& all, FaultGroup const& group) {
    constexpr char const* kPath = "record.comtrade";
    constexpr double kAroundMs = 100;
    Node& set = root.find("set") != nullptr ? *root.find("set") : root.set("set", Node::map(all.fault.where));
    if (set.is_map() && set.find(kPath) == nullptr) {
        Node& record = set.set(kPath, Node::map(all.fault.where));
        record.set("trigger", text(all.fault));
        record.set("before_ms", Node::scalar(shortest(kAroundMs)));
        record.set("after_ms", Node::scalar(shortest(group.within_ms + kAroundMs)));
    }
}

/// The study that runs a group.
std::optional<Study> study_of(CertifyCase const& all, FaultGroup const& group, std::int64_t samples,
                              Diagnostics& diagnostics) {
    Node root = Node::map();
    root.set("gridspace_study", Node::scalar("1"));
    root.set("name", text(all.name + "_" + group.name.name));
    root.set("scenario", all.scenario);
    for (auto const& [key, of_all, of_group] :
         {std::tuple{"set", &all.set, &group.set}, {"vary", &all.vary, &group.vary}}) {
        if (Node both = merged(*of_all, *of_group); !both.is_null()) {
            root.set(key, std::move(both));
        }
    }
    if (all.comtrade) {
        with_comtrade(root, all, group);
    }
    Node const* const vary = root.find("vary");
    if (vary != nullptr && std::ranges::any_of(vary->entries, is_drawn, &Node::Entry::value)) {
        Node& sampling = root.set("sampling", Node::map(group.name.where));
        std::int64_t const draws = samples > 0 ? samples : group.samples.value_or(kUsualSamples);
        sampling.set("samples", Node::scalar(std::to_string(draws), group.name.where));
        sampling.set("seed", Node::scalar(std::to_string(all.seed), group.name.where));
    } else if (group.samples) {
        diagnostics.error(group.samples_mark, "nothing is drawn: every draw would be the same fault",
                          "leave `samples` out, or let something vary by a distribution");
        return std::nullopt;
    }
    root.set("expectations", Node::sequence());
    root.set("results", results_of(all, group));
    if (!all.depends_on.is_null()) {
        root.set("depends_on", all.depends_on);
    }
    return read_study(root, all.file, diagnostics);
}

/// A run that ends before the relay's time is over would count as one in which it did not trip.
void check_end(CertifyCase const& all, FaultGroup const& group, Scenario const& scenario, Diagnostics& diagnostics) {
    auto const fault =
        std::ranges::find(scenario.events, all.fault.name, [](sim::Event const& e) { return e.name.name; });
    if (!group.must_trip || fault == scenario.events.end() || !fault->at_s) {
        return;
    }
    double const at_s = fault->at_s->to_double(), end_s = scenario.simulation.duration().to_double();
    if (at_s + group.within_ms / 1e3 > end_s) {
        diagnostics.error(
            group.within_mark,
            fmt::format("the run ends {:.6g} ms after the fault, which begins at {:.6g} s", (end_s - at_s) * 1e3, at_s),
            fmt::format("expected a run of at least {:.6g} s: simulation.duration_s in `set`",
                        at_s + group.within_ms / 1e3));
    }
}

} // namespace

std::optional<std::vector<PlannedGroup>> plan_case(CertifyCase const& all, std::int64_t samples,
                                                   Diagnostics& diagnostics) {
    std::vector<PlannedGroup> out;
    std::size_t to_trip = 0, to_stay = 0;
    for (FaultGroup const& group : all.groups) {
        auto study = study_of(all, group, samples, diagnostics);
        RunCheck const check = [&](Scenario const& scenario, Diagnostics& own) {
            check_end(all, group, scenario, own);
        };
        auto plan = study ? plan_study(*study, diagnostics, check) : std::nullopt;
        if (!plan) {
            return std::nullopt;
        }
        (group.must_trip ? to_trip : to_stay) += plan->runs.size();
        out.push_back({group, std::move(*study), std::move(*plan)});
    }
    Criteria const& asked = all.criteria;
    check_bound(asked.dependability_bound_at_least, asked.dependability_bound_mark, to_trip, all.confidence,
                diagnostics);
    check_bound(asked.security_bound_at_least, asked.security_bound_mark, to_stay, all.confidence, diagnostics);
    return diagnostics.ok() ? std::optional{std::move(out)} : std::nullopt;
}

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/certify/certify_case.hpp"

#include "common/config/merge.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;

void describe(Fields& f, Criteria& c) {
    auto const share = [&](std::string_view key, std::optional<double>& value, std::string_view doc) {
        f.number(key, value, {.doc = doc, .min = 0, .max = 1});
    };
    share("dependability_at_least", c.dependability_at_least,
          "share of the faults to trip for that it tripped for in time");
    share("dependability_bound_at_least", c.dependability_bound_at_least, "the lower end of its interval");
    share("security_at_least", c.security_at_least, "share of the faults to stay for that it stayed for");
    share("security_bound_at_least", c.security_bound_at_least, "the lower end of its interval");
    c.dependability_bound_mark = f.where("dependability_bound_at_least");
    c.security_bound_mark = f.where("security_bound_at_least");
    f.number("trip_mean_below_ms", c.trip_mean_below_ms, {.doc = "mean of the trip times", .above = 0});
    f.number("trip_p95_below_ms", c.trip_p95_below_ms, {.doc = "95 % of them", .above = 0});
    f.number("trip_max_below_ms", c.trip_max_below_ms, {.doc = "all of them", .above = 0});
}

void describe(Fields& f, FaultGroup& g) {
    f.choice<bool>("must", g.must_trip, {{"trip", true}, {"stay", false}},
                   {.doc = "what the relay has to do", .required = true});
    f.number("within_ms", g.within_ms, {.doc = "must: trip: from the fault on; later is no trip", .above = 0});
    g.within_mark = f.where("within_ms");
    std::int64_t samples = 10;
    f.integer("samples", samples,
              {.doc = "draws, each with every combination of the listed values", .min = 1, .max = kMaxStudyRuns});
    if (f.has("samples")) {
        g.samples = samples;
        g.samples_mark = f.where("samples");
    }
    f.raw("set", g.set, {.doc = "values of the scenario for this group, by their path"});
    f.raw("vary", g.vary, {.doc = "what varies in this group, as in a study"});
    if (f.has("must") && g.must_trip && !f.has("within_ms")) {
        f.error("within_ms", "how soon has it to trip?", "within_ms: 100");
    }
    if (!g.must_trip && f.has("within_ms")) {
        f.error("within_ms", "it must not trip at any time");
    }
}

/// A criterion that no fault could say anything about.
void must_have_faults(Fields& f, std::vector<FaultGroup> const& groups) {
    for (auto const& [key, must_trip] : {std::pair{"dependability_at_least", true},
                                         {"dependability_bound_at_least", true},
                                         {"trip_mean_below_ms", true},
                                         {"trip_p95_below_ms", true},
                                         {"trip_max_below_ms", true},
                                         {"security_at_least", false},
                                         {"security_bound_at_least", false}}) {
        bool const there = std::any_of(groups.begin(), groups.end(),
                                       [&, trips = must_trip](FaultGroup const& g) { return g.must_trip == trips; });
        if (f.has(key) && !there) {
            f.error(key, fmt::format("no group of faults has `must: {}`", must_trip ? "trip" : "stay"),
                    "add such a group, or leave the criterion out");
        }
    }
}

void describe(Fields& f, CertifyCase& c) {
    std::int64_t version = 1;
    f.integer("gridspace_certify", version, {.doc = "version of this format", .required = true, .min = 1, .max = 1});
    f.text("name", c.name, {.doc = "name of the case; also of its folder", .required = true});
    if (!c.name.empty() && !is_identifier(c.name)) {
        f.error("name", fmt::format("'{}' cannot be the name of a case", c.name),
                "letters, digits and _, not starting with a digit");
    }
    f.text("description", c.description, {.doc = "what it is about"});
    f.raw("scenario", c.scenario, {.doc = "the scenario with the relay, relative to this file", .required = true});
    f.reference("trip", c.trip,
                {.doc = "condition that says tripped: relay.NAME.trip == true, or of somebody else's "
                        "breaker_ied.NAME.command == true",
                 .required = true});
    f.reference("fault", c.fault, {.doc = "event of the scenario that is the fault", .required = true});
    f.raw("set", c.set, {.doc = "values of the scenario for all runs, by their path"});
    f.raw("vary", c.vary, {.doc = "what varies in all groups, as in a study"});
    f.integer("seed", c.seed, {.doc = "of the draws"});
    f.number("confidence", c.confidence, {.doc = "of the intervals", .above = 0, .below = 1});
    f.map("faults", {.doc = "groups of faults, by name", .required = true}, [&](Ref const& name, Fields& g) {
        FaultGroup group;
        group.name = name;
        describe(g, group);
        c.groups.push_back(std::move(group));
    });
    f.object("criteria", {.doc = "what is asked of the relay; the exit code is 1 when it is not met"}, [&](Fields& g) {
        describe(g, c.criteria);
        must_have_faults(g, c.groups);
    });
    f.flag("comtrade", c.comtrade, {.doc = "false: a run leaves no disturbance record around its fault"});
    f.raw("depends_on", c.depends_on, {.doc = "files that programs of yours read, as in a study"});
}

} // namespace

void describe_certify_keys(config::Fields& fields) {
    CertifyCase all;
    describe(fields, all);
}

std::optional<CertifyCase> load_certify_case(std::filesystem::path const& file, Diagnostics& diagnostics) {
    auto const root = config::load_extended(file, diagnostics);
    if (!root) {
        return std::nullopt;
    }
    for (auto const& [key, what] : {std::pair{"gridspace", "a scenario"},
                                    {"gridspace_network", "a network file"},
                                    {"gridspace_study", "a study"}}) {
        if (Node::Entry const* version = root->find_entry(key)) {
            diagnostics.error(version->where, fmt::format("this is {}, and a case is expected", what),
                              "a case names a scenario, its relay and faults: docs/tutorials/certify_a_relay.md");
            return std::nullopt;
        }
    }
    CertifyCase out;
    out.file = file;
    int const before = diagnostics.errors();
    config::read_fields(*root, "", diagnostics, [&](Fields& f) {
        describe(f, out);
        if (out.groups.empty() && f.has("faults")) {
            f.error("faults", "there is no group of faults", "{inside: {must: trip, within_ms: 100}}");
        }
    });
    return diagnostics.errors() > before ? std::nullopt : std::optional{std::move(out)};
}

} // namespace gridspace::launcher

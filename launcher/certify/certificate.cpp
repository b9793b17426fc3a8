// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/certify/certificate.hpp"

#include "common/nearest_rank.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

constexpr std::size_t kWorst = 10;

/// A condition of a run: whether it held.
bool held(RunRecord const& record, char const* name) {
    RunRecord::Value const* const v = record.find(name);
    return v != nullptr && v->passed == true;
}

struct Counts {
    std::size_t tripped{0}, to_trip{0}, stayed{0}, to_stay{0};
};

/// How bad a run is: failures first, then the slowest.
struct Ranked {
    double rank{0};
    WorstFault fault;
};

std::optional<Ranked> rank(FaultGroup const& group, RunRecord const& record) {
    double const ms = trip_time(record).value_or(0);
    auto const ranked = [](double rank, std::string why) { return Ranked{rank, {0, 0, std::move(why), {}, {}}}; };
    switch (outcome_of(group, record)) {
    case Outcome::ended_early:
        return ranked(2e9, "ended early: " + record.cause);
    case Outcome::tripped:
        return ranked(1e9, "tripped, and had to stay");
    case Outcome::before_fault:
        return ranked(1e9, "tripped before the fault");
    case Outcome::too_late:
        return ranked(1e9, fmt::format("tripped after {:.2f} ms, and had to within {:g} ms", ms, group.within_ms));
    case Outcome::no_trip:
        return ranked(1e9, "did not trip");
    case Outcome::right:
        break;
    }
    return group.must_trip ? std::optional{ranked(ms, fmt::format("tripped after {:.2f} ms", ms))} : std::nullopt;
}

/// A trip before the fault is a failure to trip for it, and a trip where the relay had to stay.
void count(FaultGroup const& group, RunRecord const& record, Counts& counts, std::vector<double>& trip_ms) {
    Outcome const outcome = outcome_of(group, record);
    counts.to_trip += group.must_trip ? 1 : 0;
    counts.to_stay += !group.must_trip || outcome == Outcome::before_fault ? 1 : 0;
    counts.stayed += !group.must_trip && outcome == Outcome::right ? 1 : 0;
    if (group.must_trip && outcome == Outcome::right) {
        ++counts.tripped;
        trip_ms.push_back(trip_time(record).value_or(0));
    }
}

void judge(Certificate& c, Criteria const& asked) {
    auto const at_least = [&](char const* name, Proportion const& p, double value, std::optional<double> const& limit) {
        if (limit) {
            c.criteria.push_back(
                {name, p.of > 0 ? std::optional{value} : std::nullopt, *limit, p.of > 0 && value >= *limit});
        }
    };
    bool const trips = !c.trip_ms.empty();
    auto const below = [&](char const* name, double value, std::optional<double> const& limit) {
        if (limit) {
            c.criteria.push_back({name, trips ? std::optional{value} : std::nullopt, *limit, trips && value < *limit});
        }
    };
    at_least("dependability_at_least", c.dependability, c.dependability.estimate, asked.dependability_at_least);
    at_least("dependability_bound_at_least", c.dependability, c.dependability.low, asked.dependability_bound_at_least);
    at_least("security_at_least", c.security, c.security.estimate, asked.security_at_least);
    at_least("security_bound_at_least", c.security, c.security.low, asked.security_bound_at_least);
    below("trip_mean_below_ms", c.mean_ms, asked.trip_mean_below_ms);
    below("trip_p95_below_ms", c.p95_ms, asked.trip_p95_below_ms);
    below("trip_max_below_ms", trips ? c.trip_ms.back() : 0, asked.trip_max_below_ms);
}

} // namespace

std::optional<double> trip_time(RunRecord const& record) {
    RunRecord::Value const* const v = record.find(kTripMs);
    return v == nullptr ? std::nullopt : v->value;
}

Outcome outcome_of(FaultGroup const& group, RunRecord const& record) {
    if (record.exit > 1) {
        return Outcome::ended_early;
    }
    if (!group.must_trip) {
        return held(record, kStayed) ? Outcome::right : Outcome::tripped;
    }
    if (!held(record, kQuietBefore)) {
        return Outcome::before_fault;
    }
    return held(record, kTripped) ? Outcome::right : trip_time(record) ? Outcome::too_late : Outcome::no_trip;
}

bool Certificate::is_passed() const {
    return inconclusive == 0 && open == 0 &&
           std::all_of(criteria.begin(), criteria.end(), [](Judged const& j) { return j.met; });
}

Certificate make_certificate(CertifyCase const& all, std::vector<GroupResult> const& groups) {
    Certificate out;
    Counts counts;
    std::vector<Ranked> ranked;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        GroupResult const& group = groups[g];
        for (std::size_t i = 0; i < group.finished.records.size(); ++i) {
            auto const& record = group.finished.records[i];
            if (!record) {
                ++out.open;
                continue;
            }
            if (auto bad = rank(group.group, *record)) {
                bad->fault.group = g;
                bad->fault.run = i;
                bad->fault.folder = group.finished.folder.run(group.plan.runs[i].key);
                bad->fault.command = group.finished.folder.command(group.plan.runs[i].key);
                ranked.push_back(std::move(*bad));
            }
            if (record->exit > 1) {
                ++out.inconclusive;
            } else {
                count(group.group, *record, counts, out.trip_ms);
            }
        }
    }
    out.dependability = clopper_pearson(counts.tripped, counts.to_trip, all.confidence);
    out.security = clopper_pearson(counts.stayed, counts.to_stay, all.confidence);
    std::sort(out.trip_ms.begin(), out.trip_ms.end());
    double sum = 0, squares = 0;
    auto const n = static_cast<double>(out.trip_ms.size());
    for (double const ms : out.trip_ms) {
        sum += ms;
    }
    out.mean_ms = n > 0 ? sum / n : 0;
    for (double const ms : out.trip_ms) {
        squares += (ms - out.mean_ms) * (ms - out.mean_ms);
    }
    out.deviation_ms = n > 1 ? std::sqrt(squares / (n - 1)) : 0;
    out.median_ms = nearest_rank(out.trip_ms, 0.5);
    out.p95_ms = nearest_rank(out.trip_ms, 0.95);
    judge(out, all.criteria);
    std::stable_sort(ranked.begin(), ranked.end(), [](Ranked const& a, Ranked const& b) { return a.rank > b.rank; });
    for (std::size_t i = 0; i < std::min(ranked.size(), kWorst); ++i) {
        out.worst.push_back(std::move(ranked[i].fault));
    }
    return out;
}

} // namespace gridspace::launcher

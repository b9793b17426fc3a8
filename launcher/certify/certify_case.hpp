// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/sweep/study_plan.hpp"

namespace gridspace::launcher {

/// Faults of one kind: those that the relay has to trip for, or those that it must stay for.
struct FaultGroup {
    Ref name;
    bool must_trip{true};
    double within_ms{0}; ///< must_trip: from the fault on; later is no trip
    config::SourceMark within_mark;
    std::optional<std::int64_t> samples; ///< draws; 10 when not given, where anything is drawn
    config::SourceMark samples_mark;
    config::Node set, vary; ///< in addition to those of the case
};

/// What the file asks of the relay. None given: it is shown and not judged.
struct Criteria {
    std::optional<double> dependability_at_least, security_at_least;             ///< share, as counted
    std::optional<double> dependability_bound_at_least, security_bound_at_least; ///< lower end of its interval
    config::SourceMark dependability_bound_mark, security_bound_mark;
    std::optional<double> trip_mean_below_ms, trip_p95_below_ms, trip_max_below_ms;
};

/// A file of `gridspace certify`: groups of seeded faults against the relay of a scenario.
struct CertifyCase {
    std::filesystem::path file;
    std::string name, description;
    config::Node scenario;  ///< the name as it is written, relative to the file
    Ref trip, fault;        ///< the condition that says tripped, and the event that is the fault
    config::Node set, vary; ///< of all groups
    std::int64_t seed{1};
    double confidence{0.95};
    std::vector<FaultGroup> groups;
    Criteria criteria;
    bool comtrade{true}; ///< each run leaves a disturbance record around its fault
    config::Node depends_on;
};

/// The keys of such a file, for its schema.
void describe_certify_keys(config::Fields& fields);

/// Reads the file; what is wrong with it alone is in `diagnostics`, and nothing is returned then.
[[nodiscard]] std::optional<CertifyCase> load_certify_case(std::filesystem::path const& file,
                                                           config::Diagnostics& diagnostics);

/// Names of the results of each run.
inline constexpr char const *kTripMs = "trip_ms", *kTripped = "tripped", *kQuietBefore = "quiet_before",
                            *kStayed = "stayed";

/// A group, and the study that runs it.
struct PlannedGroup {
    FaultGroup group;
    Study study;
    StudyPlan plan;
};
/// All groups, each run checked against the scenario. `samples`: instead of the groups' own, unless 0.
[[nodiscard]] std::optional<std::vector<PlannedGroup>> plan_case(CertifyCase const& all, std::int64_t samples,
                                                                 config::Diagnostics& diagnostics);

} // namespace gridspace::launcher

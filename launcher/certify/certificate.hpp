// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/certify/binomial_interval.hpp"
#include "launcher/certify/certify_case.hpp"
#include "launcher/sweep/sweep.hpp"

namespace gridspace::launcher {

/// What became of a group of faults.
struct GroupResult {
    FaultGroup group;
    Study study;
    StudyPlan plan;
    FinishedSweep finished;
};

/// What the relay made of a fault. A run that ended early says nothing about it.
enum class Outcome { right, before_fault, too_late, no_trip, tripped, ended_early };
[[nodiscard]] Outcome outcome_of(FaultGroup const& group, RunRecord const& record);
/// From the fault on, where it tripped at all.
[[nodiscard]] std::optional<double> trip_time(RunRecord const& record);

/// A run that somebody should look at.
struct WorstFault {
    std::size_t group{0}, run{0};
    std::string why, command;
    std::filesystem::path folder; ///< its run folder, with recording, report, frames and COMTRADE, where it is kept
};

/// A criterion of the case and how it came out.
struct Judged {
    std::string name;
    std::optional<double> value; ///< none: there was nothing to count
    double limit{0};
    bool met{false};
};

/// What the runs say about the relay.
struct Certificate {
    Proportion dependability;             ///< of the faults to trip for
    Proportion security;                  ///< of the faults to stay for; a trip before a fault counts here, too
    std::size_t inconclusive{0}, open{0}; ///< ended early; not done
    std::vector<double> trip_ms;          ///< sorted; of the trips that came in time
    double mean_ms{0}, deviation_ms{0}, median_ms{0}, p95_ms{0};
    std::vector<Judged> criteria;
    std::vector<WorstFault> worst;

    /// Every run was done, and every criterion is met.
    [[nodiscard]] bool is_passed() const;
};
[[nodiscard]] Certificate make_certificate(CertifyCase const& all, std::vector<GroupResult> const& groups);

[[nodiscard]] std::string certificate_json(CertifyCase const& all, std::vector<GroupResult> const& groups,
                                           Certificate const& certificate);
/// One page that needs nothing else and opens offline.
[[nodiscard]] std::string certificate_page(CertifyCase const& all, std::vector<GroupResult> const& groups,
                                           Certificate const& certificate);

} // namespace gridspace::launcher

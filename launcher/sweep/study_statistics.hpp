// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/sweep/run_record.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// What became of one result over all runs that have a value of it.
struct ResultStatistics {
    std::string name, unit, verb;
    std::optional<double> low, high; ///< accepted, by the first run that says so
    std::size_t count{0}, failed{0}; ///< values; of them, outside of what is accepted
    double min{0}, p05{0}, median{0}, mean{0}, p95{0}, max{0};
    std::size_t lowest{0}, highest{0}; ///< runs

    [[nodiscard]] bool is_condition() const { return verb == "always" || verb == "never" || verb == "eventually"; }
};

[[nodiscard]] std::vector<ResultStatistics> statistics_of(std::vector<std::string> const& names,
                                                          std::vector<std::optional<RunRecord>> const& records);

/// A run that somebody should look at.
struct WorstCase {
    std::size_t run{0};
    std::string why;
};

/// First the runs that ended early, then those that failed by the most, then those that passed by the least; at most
/// `most` of them. "Most" and "least" are measured by the range that a result has over all runs.
[[nodiscard]] std::vector<WorstCase> worst_cases(std::vector<ResultStatistics> const& statistics,
                                                 std::vector<std::optional<RunRecord>> const& records,
                                                 std::size_t most);

} // namespace gridspace::launcher

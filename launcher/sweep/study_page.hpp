// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/sweep/result_table.hpp"

#include <string>

namespace gridspace::launcher {

/// A study's results as one page that needs nothing else and opens offline: worst cases with the command that repeats
/// each, statistics, distributions, a scatter plot of any two columns, the runs.
[[nodiscard]] std::string study_page(Study const& study, StudyPlan const& plan,
                                     std::vector<std::optional<RunRecord>> const& records, StudyFolder const& folder);

} // namespace gridspace::launcher

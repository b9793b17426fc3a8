// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "launcher/sweep/study_folder.hpp"
#include "launcher/sweep/study_plan.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace gridspace::launcher {

/// A table of the study's runs, one row each, in the order of the design.
struct ResultTable {
    using Cell = std::variant<std::monostate, double, std::int64_t, std::string>;
    std::vector<std::string> columns;
    std::vector<std::vector<Cell>> rows;
};

/// Columns: run, key, the parameters, repetition, seed, state, exit, cause, wall_s, simulated_s, the results, folder,
/// command. `records`: by run; none: not done yet (state "open").
[[nodiscard]] ResultTable make_table(Study const& study, StudyPlan const& plan,
                                     std::vector<std::optional<RunRecord>> const& records, StudyFolder const& folder);

/// RFC 4180, one header row. Empty cells where there is no value.
[[nodiscard]] std::string to_csv(ResultTable const& table);

/// Puts a SQLite database with the table `runs` in the place of `file`, in one step.
[[nodiscard]] Result<void> write_database(std::filesystem::path const& file, ResultTable const& table);

} // namespace gridspace::launcher

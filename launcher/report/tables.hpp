// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/results.hpp"
#include "launcher/scenario/report_settings.hpp"

#include <string>
#include <vector>

namespace gridspace::launcher {

/// A table of the report: a header row of text, and rows of markup, in which names are escaped: a recording may hold
/// any.
struct ReportTable {
    std::string title;
    std::vector<std::string> header;
    std::vector<std::vector<std::string>> rows;
    std::string note{}; ///< the method, below the table
};

/// The tables of `report:`.
[[nodiscard]] std::vector<ReportTable> make_tables(ReportSettings const& settings, Results const& results);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"
#include "launcher/report/figure.hpp"
#include "launcher/report/results.hpp"

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

/// The figures that a run's signals call for: what kinds of elements it has decides, not which scenario it is. Limits
/// come from the expectations and from the thresholds in the processes' settings; deadlines from the EV agents.
[[nodiscard]] std::vector<Figure> make_figures(Results const& results, config::Node const& scenario);

/// Asked for against reached, for runs with EVs.
[[nodiscard]] std::vector<ReportTable> make_tables(Results const& results, config::Node const& scenario);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/report/tables.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace gridspace::launcher {

/// A row of a table; `tag` is th or td, cells are markup.
[[nodiscard]] std::string html_row(std::vector<std::string> const& cells, char const* tag);

/// A section with the table, its title above and its note below.
[[nodiscard]] std::string html_table(ReportTable const& table);

/// A whole page in the report's style, which opens offline. `title` is text; `body` and `script` are what stands in
/// main and behind it.
[[nodiscard]] std::string html_page(std::string_view title, std::string_view body, std::string_view script = {});

} // namespace gridspace::launcher

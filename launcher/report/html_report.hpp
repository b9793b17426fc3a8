// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "launcher/judge/results.hpp"

#include <filesystem>

namespace gridspace::launcher {

/// Writes report/index.html (one self-contained file, opens offline) with an SVG and a CSV file per figure.
/// Returns the page's path.
[[nodiscard]] Result<std::filesystem::path> write_html_report(Results const& results);

} // namespace gridspace::launcher

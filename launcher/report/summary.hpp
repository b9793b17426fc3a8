// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "launcher/judge/results.hpp"

#include <string>

namespace gridspace::launcher {

/// The summary as JSON, and the same as report/summary.json.
[[nodiscard]] std::string summary_json(Results const& results);
[[nodiscard]] Result<void> write_summary(Results const& results);

/// The tables that `gridspace run` and `gridspace report` print.
[[nodiscard]] std::string to_text(Results const& results, bool colour);

/// JUnit XML with one test case per expectation.
[[nodiscard]] std::string to_junit(Results const& results);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// The cells of one column of a CSV file (RFC 4180) whose first row has the names. Fails for a file that is not there,
/// a column that it lacks or has twice, a row of another length, an empty cell, and more than `most` rows.
[[nodiscard]] Result<std::vector<std::string>> read_column(std::filesystem::path const& file, std::string const& column,
                                                           std::size_t most);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace gridspace::sim {

struct ProfilePoints {
    std::vector<double> hours, values;
};

/// Reads the columns `hours` (or `h`, `time_h`) and `column` of a comma-separated file with one header row: at least
/// one row of finite numbers, with increasing hours. Errors name the line.
[[nodiscard]] Result<ProfilePoints> read_profile_csv(std::filesystem::path const& file, std::string const& column);

} // namespace gridspace::sim

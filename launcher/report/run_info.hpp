// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <filesystem>
#include <string>

namespace gridspace::launcher {

/// What a run folder (or a lone data.mcap) holds. Reads the recording and the capture once, judges nothing again.
struct RunInfo {
    std::string text; ///< for people
    std::string json; ///< one object
};
[[nodiscard]] Result<RunInfo> run_info(std::filesystem::path const& run);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <filesystem>
#include <string>

namespace gridspace::launcher {

/// Notes in the run folder where the monitor of the run serves.
void note_monitor(std::filesystem::path const& folder, std::string const& address);

/// "127.0.0.1:8080" of the run's monitor: from the folder, or as it is when `run` is an address or URL already.
[[nodiscard]] Result<std::string> monitor_address(std::filesystem::path const& run);

/// The body of GET `path`. An error names the address when nobody answers, and what the monitor said when it refuses.
[[nodiscard]] Result<std::string> ask_monitor(std::string const& address, std::string const& path);

} // namespace gridspace::launcher

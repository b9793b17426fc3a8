// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// How a command ended, and what it printed.
struct CommandResult {
    int code{0}; ///< its exit code; 128 and its number for a signal
    bool timed_out{false};
    std::string output, errors;
};

/// Runs a command to its end, or until `limit`, when it is killed with all that it started. `input` is its standard
/// input; empty: nothing.
[[nodiscard]] Result<CommandResult> run_limited(std::vector<std::string> words, std::chrono::seconds limit,
                                                std::filesystem::path const& input);

} // namespace gridspace::launcher

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
    bool too_long{false};       ///< it printed more than is kept
    std::string output, errors; ///< at most kMaxCommandOutput octets each
};

inline constexpr std::size_t kMaxCommandOutput = 1U << 20U;

/// Runs a command to its end, or until `limit` (of which the time counts in full in which it waits, and a twelfth of
/// that in which it computes or waits for a processor) or kMaxCommandOutput, when it is killed with all that it
/// started. `input` is its standard input; empty: nothing.
[[nodiscard]] Result<CommandResult> run_limited(std::vector<std::string> words, std::chrono::seconds limit,
                                                std::filesystem::path const& input);

} // namespace gridspace::launcher

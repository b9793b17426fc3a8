// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/unique_fd.hpp"
#include "timebox/process_numbers.hpp"

#include <string>
#include <sys/types.h>
#include <utility>
#include <vector>

namespace gridspace::timebox {

struct StartOptions {
    std::vector<std::string> command;
    std::vector<std::pair<std::string, std::string>> environment; ///< where it is not set otherwise
    std::vector<std::string> door;                                ///< another program next to it; empty: none
    int door_fd{-1};                                              ///< which that one has as kDoorFd
    /// They have nothing of this process but standard output and error, and are in a process group of their own.
    bool detached{false};
};

struct Started {
    pid_t program{0}, door{0};
    ProcessNumbers numbers;          ///< in which they are
    std::vector<UniqueFd> listeners; ///< of their calls; none: all stop under ptrace
};

/// The programs stand before their first instruction, traced, with the filter of held_calls() and without address
/// space randomisation; their exec is still to be prepared.
[[nodiscard]] Result<Started> start_traced(StartOptions const& options);

} // namespace gridspace::timebox

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/unique_fd.hpp"

#include <span>
#include <sys/types.h>

namespace gridspace::timebox {

/// Process numbers of their own for a box (a PID namespace): the first program is 2, and so on, in every run. Number 1
/// takes orphans in, and ends everybody when `life` is closed.
struct ProcessNumbers {
    UniqueFd life;
    pid_t keeper{0}; ///< number 1, as this process sees it; 0: the kernel refuses (a container without rights)

    /// Ends all of them. A tracer of some waits for them itself, before number 1 can end.
    void end();
};

/// Like fork(2), for one or two children in a new one of these: number 2 and number 3 are children of this process, in
/// which it returns 0 and 1. Where the kernel refuses, plain forks, and numbers are the machine's. In this process: -1,
/// with their numbers in `children`; those that could not be made are -1.
[[nodiscard]] int fork_numbered(ProcessNumbers& numbers, std::span<pid_t> children);

} // namespace gridspace::timebox

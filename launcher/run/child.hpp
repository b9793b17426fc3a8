// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "launcher/run/run_plan.hpp"

#include <string>
#include <sys/types.h>

namespace gridspace::launcher {

/// A started process: its pidfd, and the pipes to it.
struct Child {
    pid_t pid{-1};
    int pidfd{-1};
    int status_fd{-1};  ///< reading end of its status lines
    int control_fd{-1}; ///< writing end of its standard input (the simulator's), or -1
};

struct SpawnOptions {
    int netns{-1};     ///< network namespace to run in, or -1
    int listen_fd{-1}; ///< socket to hand over, or -1
    int board_fd{-1};  ///< shared memory of the clock to hand over, or -1
    std::int64_t incarnation{0};
};

/// Starts a process of the plan: own process group, killed when the launcher dies, standard output and error into its
/// log. What stops it from starting (program missing, namespace refused) is in the error.
[[nodiscard]] Result<Child> spawn(PlannedProcess const& process, SpawnOptions const& options);

/// Stopped by a signal (SIGSTOP, SIGTSTP) or by a debugger: it does nothing at all, its leases on the bus run out, and
/// others notice first.
[[nodiscard]] bool is_stopped(pid_t pid);

/// How a process ended: "exit code 4" or "killed by signal 9 (Killed)".
[[nodiscard]] std::string describe_end(int wait_status);

} // namespace gridspace::launcher

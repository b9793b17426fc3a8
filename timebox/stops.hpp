// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/unique_fd.hpp"

#include <csignal>
#include <optional>
#include <sys/types.h>
#include <utility>
#include <vector>

namespace gridspace::timebox {

/// An event of a thread of the box: a call of it that waits for an answer (a notification of seccomp), or what
/// waitpid(2) says.
struct Stop {
    pid_t tid{0};
    int status{0};
    bool call{false}; ///< it stands in it: call_of() and answer() of tracee.hpp
};

/// Where such stops come from. While it lives, its thread hears SIGCHLD only when it waits. The kernel tells another
/// thread that would hear it meanwhile: a process with threads of its own calls keep_child_signal() before them.
class Stops {
  public:
    static void keep_child_signal() {
        sigset_t child;
        sigemptyset(&child);
        sigaddset(&child, SIGCHLD);
        pthread_sigmask(SIG_BLOCK, &child, nullptr);
    }
    Stops();
    ~Stops();
    Stops(Stops const&) = delete;
    Stops& operator=(Stops const&) = delete;

    /// Notifications come from here as well.
    void listen(UniqueFd listener) { listeners_.push_back(std::move(listener)); }
    enum class Why { stop, interrupted, nobody_is_left };
    /// Waits for one; `of`: as of waitpid(2), of any thread.
    Why wait(Stop& out, pid_t of = -1);

  private:
    std::optional<Why> of_ptrace(Stop& out, pid_t of, bool waits);
    std::vector<UniqueFd> listeners_;
    struct sigaction action_before_{};
    sigset_t mask_before_{}, while_waiting_{};
};

} // namespace gridspace::timebox

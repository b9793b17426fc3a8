// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
#include <sys/prctl.h>
#include <unistd.h>

namespace gridspace {

/// The first thing in a child after fork: a group of its own (a Ctrl-C is for its parent), an end with its parent, and
/// signals as in a program that was just started. `parent`: its identifier, from before the fork.
inline void begin_child(pid_t parent) {
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) { // it died before that
        ::_exit(127);
    }
    sigset_t none;
    sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    ::signal(SIGPIPE, SIG_DFL);
}

} // namespace gridspace

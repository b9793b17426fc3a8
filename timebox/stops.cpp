// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/stops.hpp"

#include "timebox/tracee.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <linux/seccomp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <time.h>

namespace gridspace::timebox {
namespace {

/// Something of ptrace may be there to be waited for.
volatile std::sig_atomic_t child_told = 0;

constexpr std::size_t kMostListeners = 2; // the program's and the door's

/// After this time it looks by itself, should a thread of some library have heard SIGCHLD.
constexpr timespec kAtMost{0, 250'000'000};

} // namespace

Stops::Stops() {
    child_told = 1;
    struct sigaction told{};
    told.sa_handler = [](int) { child_told = 1; };
    ::sigaction(SIGCHLD, &told, &action_before_);
    pthread_sigmask(SIG_SETMASK, nullptr, &mask_before_);
    keep_child_signal();
    while_waiting_ = mask_before_;
    sigdelset(&while_waiting_, SIGCHLD);
    sigdelset(&while_waiting_, SIGALRM); // of the LookTimer
}

Stops::~Stops() {
    ::sigaction(SIGCHLD, &action_before_, nullptr);
    pthread_sigmask(SIG_SETMASK, &mask_before_, nullptr);
}

/// Nothing: there is none now.
std::optional<Stops::Why> Stops::of_ptrace(Stop& out, pid_t of, bool waits) {
    int status = 0;
    pid_t const tid = ::waitpid(of, &status, __WALL | (waits ? 0 : WNOHANG));
    if (tid > 0) {
        out = {.tid = tid, .status = status};
        return Why::stop;
    }
    if (tid == 0) {
        return std::nullopt;
    }
    return errno == EINTR ? Why::interrupted : Why::nobody_is_left;
}

Stops::Why Stops::wait(Stop& out, pid_t of) {
    if (listeners_.empty()) {
        return *of_ptrace(out, of, true);
    }
    while (true) {
        if (child_told != 0) {
            child_told = 0; // before the check: what comes after it is signalled again
            if (auto const found = of_ptrace(out, of, false)) {
                child_told = 1; // one signal may stand for several
                return *found;
            }
        }
        std::array<pollfd, kMostListeners> list{};
        std::size_t const count = std::min(listeners_.size(), list.size());
        for (std::size_t i = 0; i < count; ++i) {
            list[i] = {listeners_[i].get(), POLLIN, 0};
        }
        int const found = ::ppoll(list.data(), count, &kAtMost, &while_waiting_);
        if (found <= 0) {
            if (found < 0 && child_told == 0) {
                return Why::interrupted;
            }
            child_told = 1;
            continue;
        }
        for (std::size_t i = 0; i < count; ++i) {
            if ((list[i].revents & POLLIN) != 0) {
                if (pid_t const tid = take_notification(list[i].fd); tid > 0) {
                    out = {.tid = tid, .status = 0, .call = true};
                    return Why::stop;
                }
            } else if (list[i].revents != 0) { // nobody is left who could make a call
                listeners_.erase(listeners_.begin() + static_cast<std::ptrdiff_t>(i));
                child_told = 1;
                if (listeners_.empty()) {
                    return *of_ptrace(out, of, true);
                }
                break;
            }
        }
    }
}

} // namespace gridspace::timebox

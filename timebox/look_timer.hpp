// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
#include <ctime>
#include <sys/syscall.h>
#include <unistd.h>

namespace gridspace::timebox {

/// While it lives, a call of this thread that waits returns four times a second.
class LookTimer {
  public:
    LookTimer() {
        struct sigaction look{};
        look.sa_handler = [](int) {};
        ::sigaction(SIGALRM, &look, &before_);
        sigset_t alarm;
        sigemptyset(&alarm);
        sigaddset(&alarm, SIGALRM);
        pthread_sigmask(SIG_UNBLOCK, &alarm, nullptr);
        sigevent event{};
        event.sigev_notify = SIGEV_THREAD_ID;
        event.sigev_signo = SIGALRM;
        event._sigev_un._tid = static_cast<pid_t>(::syscall(SYS_gettid));
        ::timer_create(CLOCK_MONOTONIC, &event, &timer_);
        constexpr long kQuarterNs = 250'000'000;
        itimerspec const often{{0, kQuarterNs}, {0, kQuarterNs}};
        ::timer_settime(timer_, 0, &often, nullptr);
    }
    ~LookTimer() {
        ::timer_delete(timer_);
        ::sigaction(SIGALRM, &before_, nullptr);
    }
    LookTimer(LookTimer const&) = delete;
    LookTimer& operator=(LookTimer const&) = delete;

  private:
    struct sigaction before_{};
    timer_t timer_{};
};

} // namespace gridspace::timebox

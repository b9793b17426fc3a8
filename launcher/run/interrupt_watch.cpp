// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/interrupt_watch.hpp"

#include "common/exit_code.hpp"

#include <sys/signalfd.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

volatile std::sig_atomic_t requests = 0; // of the one object

void on_signal(int number) {
    if (requests == 0) {
        requests = 1;
    } else if (number != SIGHUP) {
        ::_exit(static_cast<int>(ExitCode::interrupted));
    }
}

} // namespace

InterruptWatch::InterruptWatch() {
    requests = 0;
    sigemptyset(&watched_);
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
        ::sigaction(kSignals[i], nullptr, &actions_[i]);
        if (actions_[i].sa_handler != SIG_IGN || kSignals[i] != SIGHUP) {
            sigaddset(&watched_, kSignals[i]);
        }
    }
    ::sigprocmask(SIG_BLOCK, &watched_, &before_);
    fd_ = ::signalfd(-1, &watched_, SFD_CLOEXEC | SFD_NONBLOCK);
}

InterruptWatch::~InterruptWatch() {
    ::close(fd_);
    for (std::size_t i = 0; finishing_ && i < kSignals.size(); ++i) {
        ::sigaction(kSignals[i], &actions_[i], nullptr);
    }
    ::sigprocmask(SIG_SETMASK, &before_, nullptr);
}

int InterruptWatch::take() {
    int const before = taken_;
    for (signalfd_siginfo info; ::read(fd_, &info, sizeof info) == sizeof info;) {
        taken_ += info.ssi_signo != SIGHUP || taken_ == 0 ? 1 : 0;
    }
    return taken_ - before;
}

void InterruptWatch::let_finish() {
    finishing_ = true;
    requests = taken_ > 0 ? 1 : 0;
    struct sigaction action{};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    for (int const number : kSignals) {
        if (sigismember(&watched_, number) == 1) {
            ::sigaction(number, &action, nullptr);
        }
    }
    ::sigprocmask(SIG_SETMASK, &before_, nullptr); // what waits comes now
}

bool InterruptWatch::came_late() const {
    return taken_ == 0 && requests > 0;
}

} // namespace gridspace::launcher

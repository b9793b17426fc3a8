// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <csignal>

namespace gridspace::launcher {

/// Requests to stop: Ctrl-C (SIGINT), SIGTERM, and a terminal that was closed (SIGHUP). Under `nohup` SIGHUP stays
/// ignored; SIGINT, which a script has its background ignore, does not: who sends it means this run. A terminal that
/// closes may say so several times; a hang-up is never the second request. At most one object at a time.
///
/// First they are blocked and read from a file descriptor, from before anything is made until everything is gone. After
/// `let_finish()`, while the report is written, the first is noted and the second ends the process with 130.
class InterruptWatch {
  public:
    InterruptWatch();
    ~InterruptWatch();
    InterruptWatch(InterruptWatch const&) = delete;
    InterruptWatch& operator=(InterruptWatch const&) = delete;

    [[nodiscard]] int fd() const { return fd_; }
    /// How many requests came since the last call.
    int take();

    void let_finish();
    /// A request came after everything was over, that is after the last take().
    [[nodiscard]] bool came_late() const;

  private:
    static constexpr std::array<int, 3> kSignals{SIGINT, SIGTERM, SIGHUP};
    int fd_{-1};
    int taken_{0};
    sigset_t watched_{}, before_{};
    std::array<struct sigaction, 3> actions_{};
    bool finishing_{false};
};

} // namespace gridspace::launcher

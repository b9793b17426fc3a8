// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/unique_fd.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <sys/types.h>

namespace gridspace::timebox {

/// When a timer rings next, and how often after that (0: once). Simulated, ns.
struct Timer {
    std::int64_t next_ns{0}, interval_ns{0};
};

/// The timers of the programs in the box. A timerfd is an eventfd here: it becomes readable when we count it up, and
/// who reads it gets the count and sets it back, which is what a timerfd does. An alarm is a signal to its process.
class Timers {
  public:
    /// Open files, whatever descriptors they have; `file` is a copy.
    void create(pid_t process, int fd, UniqueFd file, int clock);
    struct File {
        UniqueFd file;
        int clock{0};
        std::optional<Timer> timer;
    };
    [[nodiscard]] File* find(pid_t process, int fd);
    static void forget_count(File const& file); ///< it has been set anew
    void forked(pid_t parent, pid_t child);     ///< the child has the same files
    void ended(pid_t process);

    void set_alarm(pid_t process, std::optional<Timer> timer);
    [[nodiscard]] std::optional<Timer> alarm_of(pid_t process) const;

    [[nodiscard]] std::optional<std::int64_t> next_ns() const;
    /// Rings what is due. `on_alarm(process)`: SIGALRM is to be sent.
    template <class OnAlarm>
    void ring(std::int64_t now_ns, OnAlarm&& on_alarm) {
        for (auto& [key, entry] : files_) {
            if (std::uint64_t const times = count(entry.timer, now_ns); times > 0) {
                add(entry, times);
            }
        }
        for (auto& [process, timer] : alarms_) {
            if (count(timer, now_ns) > 0) {
                on_alarm(process);
            }
        }
    }

  private:
    /// How often it has rung up to now; it is then set to its next time, or off.
    [[nodiscard]] static std::uint64_t count(std::optional<Timer>& timer, std::int64_t now_ns);
    static void add(File const& entry, std::uint64_t times);

    std::map<std::pair<pid_t, int>, File> files_;
    std::map<pid_t, std::optional<Timer>> alarms_;
};

} // namespace gridspace::timebox

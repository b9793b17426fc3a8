// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/timers.hpp"

#include <algorithm>
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

namespace gridspace::timebox {

void Timers::create(pid_t process, int fd, UniqueFd file, int clock) {
    files_[{process, fd}] = {std::move(file), clock, std::nullopt};
}

Timers::File* Timers::find(pid_t process, int fd) {
    auto const it = files_.find({process, fd});
    return it == files_.end() ? nullptr : &it->second;
}

void Timers::forget_count(File const& file) {
    pollfd entry{file.file.get(), POLLIN, 0};
    if (::poll(&entry, 1, 0) > 0) {
        std::uint64_t times = 0;
        (void)!::read(file.file.get(), &times, sizeof times);
    }
}

void Timers::forked(pid_t parent, pid_t child) {
    std::map<std::pair<pid_t, int>, File> inherited;
    for (auto const& [key, entry] : files_) {
        if (key.first == parent) { // it rings for both through one of them; the child's settings are its own
            inherited[{child, key.second}] = {UniqueFd{::fcntl(entry.file.get(), F_DUPFD_CLOEXEC, 0)}, entry.clock,
                                              std::nullopt};
        }
    }
    files_.merge(inherited);
}

void Timers::ended(pid_t process) {
    std::erase_if(files_, [&](auto const& entry) { return entry.first.first == process; });
    alarms_.erase(process);
}

void Timers::set_alarm(pid_t process, std::optional<Timer> timer) {
    alarms_[process] = timer;
}

std::optional<Timer> Timers::alarm_of(pid_t process) const {
    auto const it = alarms_.find(process);
    return it == alarms_.end() ? std::nullopt : it->second;
}

std::optional<std::int64_t> Timers::next_ns() const {
    std::optional<std::int64_t> out;
    auto const look = [&](std::optional<Timer> const& timer) {
        if (timer) {
            out = std::min(out.value_or(timer->next_ns), timer->next_ns);
        }
    };
    for (auto const& [key, entry] : files_) {
        look(entry.timer);
    }
    for (auto const& [process, timer] : alarms_) {
        look(timer);
    }
    return out;
}

std::uint64_t Timers::count(std::optional<Timer>& timer, std::int64_t now_ns) {
    if (!timer || timer->next_ns > now_ns) {
        return 0;
    }
    if (timer->interval_ns <= 0) {
        timer.reset();
        return 1;
    }
    std::int64_t const times = (now_ns - timer->next_ns) / timer->interval_ns + 1;
    timer->next_ns += times * timer->interval_ns;
    return static_cast<std::uint64_t>(times);
}

void Timers::add(File const& entry, std::uint64_t times) {
    (void)!::write(entry.file.get(), &times, sizeof times);
}

} // namespace gridspace::timebox

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/call_table.hpp"

#include <algorithm>
#include <cerrno>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/timerfd.h>

namespace gridspace::timebox {
namespace {

timeval to_timeval(std::int64_t ns) {
    return {ns / 1'000'000'000, ns % 1'000'000'000 / 1000};
}

} // namespace

CallTable::Next CallTable::timer(Thread& t) {
    auto const& a = t.call.arguments;
    if (t.call.number == SYS_timerfd_create) {
        Call eventfd = t.call; // the flags are the same
        eventfd.number = SYS_eventfd2;
        eventfd.arguments = {0, a[1]};
        replace(t.tid, eventfd);
        t.on_exit = Thread::OnExit::new_timer;
        return Next::go_to_exit;
    }
    auto const remaining = [&](std::optional<Timer> const& timer) {
        return timer ? std::max<std::int64_t>(timer->next_ns - clock_.now_ns(), 0) : 0;
    };
    if (t.call.number == SYS_alarm || t.call.number == SYS_setitimer) {
        if (t.call.number == SYS_setitimer && a[0] != ITIMER_REAL) {
            return refuse(t, "setitimer of processor time", ENOSYS);
        }
        auto const before = timers_.alarm_of(t.process);
        itimerval value{};
        if (t.call.number == SYS_alarm) {
            value.it_value.tv_sec = static_cast<time_t>(a[0]);
        } else if (a[1] != 0) {
            value = value_at<itimerval>(t.tid, a[1]);
        }
        std::int64_t const first = to_ns(value.it_value);
        timers_.set_alarm(t.process, first > 0 ? std::optional{Timer{clock_.now_ns() + first, to_ns(value.it_interval)}}
                                               : std::nullopt);
        if (t.call.number == SYS_setitimer && a[2] != 0) {
            put(t.tid, a[2], itimerval{to_timeval(before ? before->interval_ns : 0), to_timeval(remaining(before))});
        }
        answer(t.tid, t.call.number == SYS_alarm ? (remaining(before) + 999'999'999) / 1'000'000'000 : 0);
        return Next::go;
    }
    Timers::File* const file = timers_.find(t.process, static_cast<int>(a[0]));
    if (file == nullptr) {
        return Next::go; // the kernel says that it is none
    }
    itimerspec const before{to_timespec(file->timer ? file->timer->interval_ns : 0),
                            to_timespec(remaining(file->timer))};
    if (t.call.number == SYS_timerfd_gettime) {
        put(t.tid, a[1], before);
    } else {
        auto const value = value_at<itimerspec>(t.tid, a[2]);
        std::int64_t const first = timebox::to_ns(value.it_value);
        bool const absolute = (a[1] & TFD_TIMER_ABSTIME) != 0;
        file->timer.reset();
        if (first != 0) {
            file->timer = Timer{absolute ? clock_.when(file->clock, first) : clock_.now_ns() + first,
                                timebox::to_ns(value.it_interval)};
        }
        Timers::forget_count(*file);
        if (a[3] != 0) {
            put(t.tid, a[3], before);
        }
    }
    answer(t.tid, 0);
    return Next::go;
}

} // namespace gridspace::timebox

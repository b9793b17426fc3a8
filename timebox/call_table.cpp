// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/call_table.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <csignal>
#include <fmt/format.h>
#include <fstream>
#include <linux/futex.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/times.h>
#include <sys/wait.h>

namespace gridspace::timebox {
namespace {

constexpr std::uint64_t kSignalPid = 16; // of si_pid in siginfo_t
/// signal(7): by default nothing happens. The kernel keeps them for a tracer all the same.
constexpr std::uint64_t kIgnoredUnlessCaught =
    1ULL << (SIGCHLD - 1) | 1ULL << (SIGURG - 1) | 1ULL << (SIGWINCH - 1) | 1ULL << (SIGCONT - 1);
constexpr int kSocketKind = 0xF; // of socket(2): without SOCK_CLOEXEC and SOCK_NONBLOCK

} // namespace

CallTable::CallTable(BoxOptions const& options, BoxReport& report)
    : clock_{options.epoch_unix_s}, random_{options.seed}, report_{report} {
    clock_.elapse_to(options.begin_ns);
    if (options.link) {
        packets_.emplace(*options.link, clock_.reading_ns(CLOCK_REALTIME) - clock_.now_ns());
        packet_calls_.emplace(*packets_, clock_, [this](std::string const& what) { ++report_.refused[what]; });
        if (options.link->ip) {
            ip_.emplace(*options.link->ip, options.link->index, options.seed, [this](std::span<std::uint8_t const> f) {
                std::string why = packets_->link().send(f, clock_.now_ns());
                if (why.empty()) {
                    packets_->leaves(f, clock_.now_ns());
                } else {
                    ++report_.refused[why];
                }
                return why;
            });
            ip_calls_.emplace(*ip_, [this](std::string const& what) { ++report_.refused[what]; });
        }
    }
}

CallTable::Next CallTable::enter(Thread& t) {
    t.call = call_of(t.tid);
    t.what = find_held_call(t.call.number);
    t.on_exit = Thread::OnExit::nothing;
    if (t.what == nullptr) {
        return Next::go;
    }
    ++calls_[t.what];
    if (packets_) {
        packets_->deliver(clock_.now_ns()); // who does nothing but look gets them too
    }
    if (ip_) {
        ip_->bring_up_to(clock_.now_ns());
    }
    t.progress = 0;
    switch (t.what->treatment) {
    case Treatment::clock:
        return answer_clock(t);
    case Treatment::sleep:
        return sleep(t);
    case Treatment::descriptors:
        return look_at_descriptors(t);
    case Treatment::receive:
        return transfer(t, POLLIN);
    case Treatment::send:
        return transfer(t, POLLOUT);
    case Treatment::futex:
        return futex(t);
    case Treatment::child:
        return wait_for_child(t);
    case Treatment::timer:
        return timer(t);
    case Treatment::option:
        return option(t);
    case Treatment::packet:
        return packet(t);
    case Treatment::refused:
        return refuse(t, t.what->name, t.what->error);
    case Treatment::signal: {
        auto const wait = t.call.arguments[2];
        return hold_until(t, t.call.number == SYS_rt_sigtimedwait && wait != 0
                                 ? std::optional{clock_.now_ns() + timebox::to_ns(value_at<timespec>(t.tid, wait))}
                                 : std::nullopt);
    }
    case Treatment::random:
        return get_random(t);
    case Treatment::yield:
        clock_.look();
        answer(t.tid, 0);
        return Next::let_others_go;
    case Treatment::kill:
        signalled_.insert(0); // which one is theirs to see
        return Next::go;
    }
    return Next::go;
}

CallTable::Next CallTable::answer_clock(Thread& t) {
    auto const& a = t.call.arguments;
    std::int64_t result = 0;
    switch (t.call.number) {
    case SYS_clock_gettime:
        put(t.tid, a[1], to_timespec(clock_.reading_ns(static_cast<clockid_t>(a[0]))));
        break;
    case SYS_gettimeofday:
        if (a[0] != 0) {
            std::int64_t const ns = clock_.reading_ns(CLOCK_REALTIME);
            put(t.tid, a[0], timeval{ns / 1'000'000'000, ns % 1'000'000'000 / 1000});
        }
        break;
    case SYS_time:
        result = clock_.reading_ns(CLOCK_REALTIME) / 1'000'000'000;
        if (a[0] != 0) {
            put(t.tid, a[0], result);
        }
        break;
    default: { // times(2): in hundredths of a second
        result = clock_.now_ns() / 10'000'000;
        if (a[0] != 0) {
            put(t.tid, a[0], tms{result, 0, 0, 0});
        }
    }
    }
    look_again();
    answer(t.tid, result);
    return Next::go;
}

/// Who looks again and again, without waiting, gets on, and lets others do so.
void CallTable::look_again() {
    clock_.look();
    ++report_.clock_reads;
}

void CallTable::count_looks(std::array<std::int64_t, 3> const& looks) {
    constexpr std::array kNumbers{SYS_clock_gettime, SYS_gettimeofday, SYS_time};
    for (std::size_t i = 0; i < looks.size(); ++i) {
        if (looks[i] > 0) {
            calls_[find_held_call(kNumbers[i])] += static_cast<std::uint64_t>(looks[i]);
            report_.clock_reads += static_cast<std::uint64_t>(looks[i]);
        }
    }
}

CallTable::Next CallTable::hold_until(Thread& t, std::optional<std::int64_t> deadline_ns) {
    t.deadline_ns = deadline_ns;
    t.since_ns = clock_.now_ns();
    ++report_.held;
    t.interrupted = t.child_ended = false;
    return Next::hold;
}

CallTable::Next CallTable::sleep(Thread& t) {
    auto const& a = t.call.arguments;
    bool const on_a_clock = t.call.number == SYS_clock_nanosleep;
    std::int64_t const ns = timebox::to_ns(value_at<timespec>(t.tid, on_a_clock ? a[2] : a[0]));
    bool const absolute = on_a_clock && (a[1] & TIMER_ABSTIME) != 0;
    t.interests.clear();
    return hold_until(t, absolute ? clock_.when(static_cast<clockid_t>(a[0]), ns) : clock_.now_ns() + ns);
}

CallTable::Next CallTable::look_at_descriptors(Thread& t) {
    DescriptorWait const wait = wait_of(t.tid, t.call);
    if (packets_) {
        packets_->look_at_rings();
    }
    if (wait.timeout_ns == 0) {
        look_again();
        return Next::go;
    }
    if (std::int64_t const found = descriptors(t.process).look(t.tid, t.call, false); found != 0) {
        ++report_.held;
        answer(t.tid, found);
        return Next::go;
    }
    t.interests = interests_of(t.tid, t.call);
    auto const next = hold_until(t, wait.timeout_ns ? std::optional{clock_.now_ns() + *wait.timeout_ns} : std::nullopt);
    t.signal_mask_at = wait.signal_mask_at;
    t.interrupted = wait.signal_mask_at != 0 && has_signal(t); // one that it blocks otherwise
    return next;
}

CallTable::Next CallTable::transfer(Thread& t, short event) {
    auto const fd = static_cast<int>(t.call.arguments[0]);
    UniqueFd const file = descriptors(t.process).copy_of(fd);
    bool const waits = (flags_of(t.call) & MSG_DONTWAIT) == 0 && !does_not_block(file);
    if (PacketSocket* const socket = packets_ ? packets_->find(file) : nullptr) {
        return packet_transfer(t, *socket, file, event, waits);
    }
    if (IpSocket* const socket = ip_ ? ip_->find(file) : nullptr) {
        return ip_transfer(t, *socket, file, event, waits);
    }
    if (event == POLLIN && read_random(t, file)) {
        return Next::go;
    }
    bool const is_there = is_ready(file, event);
    if (!waits && !is_there) {
        look_again();
    }
    if (!waits || is_there) {
        return Next::go;
    }
    t.interests = {{fd, event}};
    auto const patience = event == POLLIN ? exact_receive_timeout_ns(file) : std::nullopt;
    return hold_until(t, patience ? std::optional{clock_.now_ns() + *patience} : std::nullopt);
}

CallTable::Next CallTable::futex(Thread& t) {
    auto const& a = t.call.arguments;
    auto const operation = static_cast<int>(a[1]);
    Futexes::Place const place{t.process, a[0]};
    auto const value = static_cast<std::uint32_t>(a[2]);
    switch (operation & FUTEX_CMD_MASK) {
    case FUTEX_WAIT:
    case FUTEX_WAIT_BITSET: {
        if (value_at<std::uint32_t>(t.tid, a[0]) != value) {
            answer(t.tid, -EAGAIN);
            return Next::go;
        }
        bool const bitset = (operation & FUTEX_CMD_MASK) == FUTEX_WAIT_BITSET; // its time is absolute
        std::optional<std::int64_t> deadline;
        if (a[3] != 0) {
            std::int64_t const ns = timebox::to_ns(value_at<timespec>(t.tid, a[3]));
            clockid_t const of = (operation & FUTEX_CLOCK_REALTIME) != 0 ? CLOCK_REALTIME : CLOCK_MONOTONIC;
            deadline = bitset ? clock_.when(of, ns) : clock_.now_ns() + ns;
        }
        futexes_.wait(t.tid, place, value, bitset ? static_cast<std::uint32_t>(a[5]) : FUTEX_BITSET_MATCH_ANY);
        t.interests.clear();
        return hold_until(t, deadline);
    }
    case FUTEX_WAKE:
    case FUTEX_WAKE_BITSET: {
        bool const bitset = (operation & FUTEX_CMD_MASK) == FUTEX_WAKE_BITSET;
        answer(t.tid, futexes_.wake(place, bitset ? static_cast<std::uint32_t>(a[5]) : FUTEX_BITSET_MATCH_ANY, value));
        return Next::go;
    }
    case FUTEX_REQUEUE:
    case FUTEX_CMP_REQUEUE: // to be woken for nothing is allowed; who is moved looks again and waits there
        answer(t.tid, futexes_.wake(place, FUTEX_BITSET_MATCH_ANY, INT32_MAX));
        return Next::go;
    default:
        return refuse(t, fmt::format("futex operation {}", operation & FUTEX_CMD_MASK), ENOSYS);
    }
}

CallTable::Next CallTable::wait_for_child(Thread& t) {
    std::size_t const options = t.call.number == SYS_wait4 ? 2 : 3;
    if ((t.call.arguments[options] & WNOHANG) != 0) {
        return Next::go;
    }
    Call trial = t.call;
    trial.arguments[options] |= WNOHANG;
    replace(t.tid, trial);
    t.on_exit = Thread::OnExit::wait_or_restore;
    return Next::go_to_exit;
}

CallTable::Next CallTable::refuse(Thread& t, std::string const& what, int error) {
    ++report_.refused[what];
    answer(t.tid, -error);
    return Next::go;
}

CallTable::Next CallTable::leave(Thread& t) {
    std::int64_t const result = result_of(t.tid);
    auto const done = std::exchange(t.on_exit, Thread::OnExit::nothing);
    if (done == Thread::OnExit::new_timer) {
        if (result >= 0) {
            auto const fd = static_cast<int>(result);
            timers_.create(t.process, fd, descriptors(t.process).copy_of(fd), static_cast<int>(t.call.arguments[0]));
        }
        restore(t.tid, t.call);
        return Next::go;
    }
    if (done == Thread::OnExit::new_packet_socket) {
        UniqueFd const file = descriptors(t.process).copy_of(static_cast<int>(result));
        bool const made = result >= 0 && packets_->add(file, static_cast<int>(t.call.arguments[1]) & kSocketKind,
                                                       ntohs(static_cast<std::uint16_t>(t.call.arguments[2])));
        report_.refused["a packet socket (no room)"] += made ? 0 : 1;
        restore(t.tid, t.call);
        return Next::go;
    }
    if (done == Thread::OnExit::new_ip_socket || done == Thread::OnExit::ip_accepted) {
        ip_leave(t, done, result);
        return Next::go;
    }
    if (done == Thread::OnExit::ring_mapped) {
        if (Named const named = packet_socket_of(t, 4); result > 0 && named.socket != nullptr) {
            named.socket->ring->process = t.process;
            named.socket->ring->address = static_cast<std::uint64_t>(result);
        }
        restore(t.tid, t.call);
        return Next::go;
    }
    if (done != Thread::OnExit::wait_or_restore) {
        return Next::go;
    }
    bool nothing = result == 0;
    if (t.call.number == SYS_waitid && result == 0 && t.call.arguments[2] != 0) {
        nothing = value_at<int>(t.tid, t.call.arguments[2] + kSignalPid) == 0;
    }
    if (nothing) {
        make_again(t.tid, t.call);
        t.made_again = true;
        t.interrupted = t.child_ended = false;
        t.deadline_ns.reset();
        t.since_ns = clock_.now_ns();
        t.interests.clear();
        ++report_.held;
        return Next::hold;
    }
    restore(t.tid, t.call);
    return Next::go;
}

/// nanosleep(2): an interrupted call says what is left, and most programs sleep on for that.
void CallTable::tell_rest_of_sleep(Thread const& t) {
    auto const& a = t.call.arguments;
    bool const on_a_clock = t.call.number == SYS_clock_nanosleep;
    bool const absolute = on_a_clock && (a[1] & TIMER_ABSTIME) != 0;
    std::uint64_t const rest_at = on_a_clock ? a[3] : a[1];
    if (t.what->treatment == Treatment::sleep && !absolute && rest_at != 0 && t.deadline_ns) {
        put(t.tid, rest_at, to_timespec(std::max<std::int64_t>(*t.deadline_ns - clock_.now_ns(), 0)));
    }
}

CallTable::Next CallTable::release(Thread& t) {
    bool const over = t.deadline_ns && *t.deadline_ns <= clock_.now_ns();
    if (t.made_again) { // it stands before its call: it comes to enter() once more
        t.made_again = t.child_ended = false;
        return Next::go;
    }
    if (t.interrupted) {
        futexes_.leave(t.tid);
        tell_rest_of_sleep(t);
        bool const has_mask_of_its_own = t.what->treatment == Treatment::descriptors && t.signal_mask_at != 0;
        if (t.what->treatment != Treatment::signal && !has_mask_of_its_own) {
            answer(t.tid, -EINTR);
        }
        return Next::go; // a wait for signals, or with a mask of its own, runs and finds it
    }
    switch (t.what->treatment) {
    case Treatment::sleep:
        answer(t.tid, 0);
        return Next::go;
    case Treatment::futex:
        answer(t.tid, futexes_.is_woken(t.tid) ? 0 : -ETIMEDOUT);
        futexes_.leave(t.tid);
        return Next::go;
    case Treatment::signal:
        answer(t.tid, -EAGAIN);
        return Next::go;
    case Treatment::receive:
    case Treatment::send:
    case Treatment::packet:
        if (NamedIp const ip = ip_socket_of(t); ip.socket != nullptr) {
            return ip_release(t, *ip.socket, ip.file, over && !descriptors_ready(t));
        }
        if (over && !descriptors_ready(t)) {
            answer(t.tid, -EAGAIN);
        } else if (Named const named = packet_socket_of(t); named.socket != nullptr) {
            answer(t.tid, packet_calls_->receive(t, *named.socket, named.file));
        }
        return Next::go;
    case Treatment::descriptors: {
        std::int64_t const found = descriptors(t.process).look(t.tid, t.call, over);
        if (found == 0 && !over) {
            return Next::hold;
        }
        answer(t.tid, found);
        return Next::answered;
    }
    default:
        return Next::go;
    }
}

bool CallTable::may_go(Thread const& t) const {
    return (t.deadline_ns && *t.deadline_ns <= clock_.now_ns()) || t.interrupted || t.child_ended ||
           futexes_.is_woken(t.tid);
}

bool CallTable::descriptors_ready(Thread const& t) {
    return descriptors(t.process).any_ready(t.interests);
}

bool CallTable::has_signal(Thread const& t) const {
    std::ifstream status{fmt::format("/proc/{}/task/{}/status", t.process, t.tid)};
    std::uint64_t pending = 0, blocked = 0, ignored = 0, caught = 0;
    for (std::string line; std::getline(status, line);) {
        auto const mask = [&] { return std::stoull(line.substr(line.find(':') + 1), nullptr, 16); };
        if (line.starts_with("SigPnd") || line.starts_with("ShdPnd")) {
            pending |= mask();
        } else if (line.starts_with("SigBlk")) {
            blocked = mask();
        } else if (line.starts_with("SigIgn")) {
            ignored = mask();
        } else if (line.starts_with("SigCgt")) {
            caught = mask();
        }
    }
    if (t.what != nullptr && t.what->treatment == Treatment::descriptors && t.signal_mask_at != 0) {
        blocked = value_at<std::uint64_t>(t.tid, t.signal_mask_at);
    } else if (t.call.number == SYS_rt_sigsuspend) {
        blocked = value_at<std::uint64_t>(t.tid, t.call.arguments[0]);
    } else if (t.call.number == SYS_rt_sigtimedwait) {
        return (pending & value_at<std::uint64_t>(t.tid, t.call.arguments[0])) != 0;
    }
    return (pending & ~blocked & ~ignored & ~(kIgnoredUnlessCaught & ~caught)) != 0;
}

Descriptors const& CallTable::descriptors(pid_t process) {
    return descriptors_.try_emplace(process, process).first->second;
}

void CallTable::forget(pid_t process) {
    descriptors_.erase(process);
    timers_.ended(process);
}

void CallTable::forget_image(pid_t process) {
    auto const alarm = timers_.alarm_of(process);
    forget(process);
    timers_.set_alarm(process, alarm);
}

} // namespace gridspace::timebox

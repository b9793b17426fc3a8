// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/held_calls.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <fmt/format.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <vector>

namespace gridspace::timebox {
namespace {

#ifndef SYS_epoll_pwait2
#define SYS_epoll_pwait2 441
#endif

/// SIOC* (0x89..) and FIONREAD (0x541b) have one of these; what asks a terminal has not.
constexpr std::uint32_t kSocketRequests = 0x8008;

constexpr std::array kCalls = std::to_array<HeldCall>({
    {SYS_clock_gettime, "clock_gettime", Treatment::clock},
    {SYS_gettimeofday, "gettimeofday", Treatment::clock},
    {SYS_time, "time", Treatment::clock},
    {SYS_times, "times", Treatment::clock},
    {SYS_nanosleep, "nanosleep", Treatment::sleep},
    {SYS_clock_nanosleep, "clock_nanosleep", Treatment::sleep},
    {SYS_poll, "poll", Treatment::descriptors},
    {SYS_ppoll, "ppoll", Treatment::descriptors},
    {SYS_select, "select", Treatment::descriptors},
    {SYS_pselect6, "pselect6", Treatment::descriptors},
    {SYS_epoll_wait, "epoll_wait", Treatment::descriptors},
    {SYS_epoll_pwait, "epoll_pwait", Treatment::descriptors},
    {SYS_epoll_pwait2, "epoll_pwait2", Treatment::descriptors},
    {SYS_read, "read", Treatment::receive},
    {SYS_readv, "readv", Treatment::receive},
    {SYS_recvfrom, "recvfrom", Treatment::receive},
    {SYS_recvmsg, "recvmsg", Treatment::receive},
    {SYS_recvmmsg, "recvmmsg", Treatment::receive},
    {SYS_accept, "accept", Treatment::receive},
    {SYS_accept4, "accept4", Treatment::receive},
    {SYS_write, "write", Treatment::send},
    {SYS_writev, "writev", Treatment::send},
    {SYS_sendto, "sendto", Treatment::send},
    {SYS_sendmsg, "sendmsg", Treatment::send},
    {SYS_sendmmsg, "sendmmsg", Treatment::send},
    {SYS_futex, "futex", Treatment::futex},
    {SYS_wait4, "wait4", Treatment::child},
    {SYS_waitid, "waitid", Treatment::child},
    {SYS_pause, "pause", Treatment::signal},
    {SYS_rt_sigsuspend, "rt_sigsuspend", Treatment::signal},
    {SYS_rt_sigtimedwait, "rt_sigtimedwait", Treatment::signal},
    {SYS_timerfd_create, "timerfd_create", Treatment::timer},
    {SYS_timerfd_settime, "timerfd_settime", Treatment::timer},
    {SYS_timerfd_gettime, "timerfd_gettime", Treatment::timer},
    {SYS_setitimer, "setitimer", Treatment::timer},
    {SYS_alarm, "alarm", Treatment::timer},
    {SYS_getrandom, "getrandom", Treatment::random},
    {SYS_sched_yield, "sched_yield", Treatment::yield},
    {SYS_kill, "kill", Treatment::kill},
    {SYS_tkill, "tkill", Treatment::kill},
    {SYS_tgkill, "tgkill", Treatment::kill},
    {SYS_pidfd_send_signal, "pidfd_send_signal", Treatment::kill},
    {SYS_setsockopt, "setsockopt", Treatment::option},
    {SYS_socket, "socket", Treatment::packet},
    {SYS_bind, "bind", Treatment::packet},
    {SYS_getsockname, "getsockname", Treatment::packet},
    {SYS_getsockopt, "getsockopt", Treatment::packet},
    {SYS_connect, "connect", Treatment::packet},
    {SYS_listen, "listen", Treatment::packet},
    {SYS_getpeername, "getpeername", Treatment::packet},
    {SYS_sendfile, "sendfile", Treatment::packet},
    {SYS_ioctl, "ioctl", Treatment::packet, 0, 1, kSocketRequests},
    {SYS_mmap, "mmap", Treatment::packet, 0, 3, MAP_SHARED},
    {SYS_timer_create, "timer_create", Treatment::refused, ENOSYS},
    {SYS_io_uring_setup, "io_uring_setup", Treatment::refused, ENOSYS},
    {SYS_perf_event_open, "perf_event_open", Treatment::refused, EPERM},
    {SYS_clock_settime, "clock_settime", Treatment::refused, EPERM},
    {SYS_settimeofday, "settimeofday", Treatment::refused, EPERM},
    {SYS_clock_adjtime, "clock_adjtime", Treatment::refused, EPERM},
});

sock_filter statement(std::uint16_t code, std::uint32_t k) {
    return {code, 0, 0, k};
}

} // namespace

std::span<HeldCall const> held_calls() {
    return kCalls;
}

HeldCall const* find_held_call(long number) {
    auto const it = std::find_if(kCalls.begin(), kCalls.end(), [&](HeldCall const& c) { return c.number == number; });
    return it == kCalls.end() ? nullptr : &*it;
}

bool is_answered_at_entry(HeldCall const& call) {
    switch (call.treatment) {
    case Treatment::clock:
    case Treatment::sleep:
    case Treatment::descriptors:
    case Treatment::send:
    case Treatment::futex:
    case Treatment::yield:
        return true;
    case Treatment::receive:
        return call.number != SYS_accept && call.number != SYS_accept4;
    default:
        return false;
    }
}

namespace {

std::vector<sock_filter> filter(bool notifies) {
    std::vector<sock_filter> program;
    program.push_back(statement(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, arch)));
    program.push_back({BPF_JMP | BPF_JEQ | BPF_K, 1, 0, AUDIT_ARCH_X86_64});
    program.push_back(statement(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ENOSYS)); // calls of 32 bits would not be seen
    program.push_back(statement(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)));
    for (HeldCall const& call : kCalls) {
        bool const always = call.argument < 0;
        program.push_back({BPF_JMP | BPF_JEQ | BPF_K, 0, static_cast<std::uint8_t>(always ? 1 : 4),
                           static_cast<std::uint32_t>(call.number)});
        if (!always) { // the low half, on machines of this order of octets
            auto const at = offsetof(seccomp_data, args) + 8 * static_cast<std::size_t>(call.argument);
            program.push_back(statement(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(at)));
            program.push_back({BPF_JMP | BPF_JSET | BPF_K, 1, 0, call.bits});
            program.push_back(statement(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
        }
        program.push_back(statement(BPF_RET | BPF_K, notifies && is_answered_at_entry(call) ? SECCOMP_RET_USER_NOTIF
                                                                                            : SECCOMP_RET_TRACE));
    }
    program.push_back(statement(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
    return program;
}

/// A signal does not take a notified call away from who answers it: he decides.
constexpr unsigned kKillableOnly = 1U << 5U; // SECCOMP_FILTER_FLAG_WAIT_KILLABLE_RECV, Linux 5.19

} // namespace

int install_filter() {
    if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) {
        return errno;
    }
    for (bool const notifies : {true, false}) {
        std::vector<sock_filter> program = filter(notifies);
        sock_fprog const code{static_cast<unsigned short>(program.size()), program.data()};
        unsigned const flags = notifies ? SECCOMP_FILTER_FLAG_NEW_LISTENER | kKillableOnly : 0;
        if (::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, flags, &code) >= 0) {
            return 0;
        }
    }
    return errno;
}

UniqueFd listener_of(pid_t process) {
    std::error_code none;
    for (auto const& entry : std::filesystem::directory_iterator{fmt::format("/proc/{}/fd", process), none}) {
        if (std::filesystem::read_symlink(entry.path(), none) != "anon_inode:seccomp notify") {
            continue;
        }
        UniqueFd const of{static_cast<int>(::syscall(SYS_pidfd_open, process, 0))};
        std::string const name = entry.path().filename();
        int fd = -1;
        (void)std::from_chars(name.data(), name.data() + name.size(), fd);
        UniqueFd out{static_cast<int>(::syscall(SYS_pidfd_getfd, of.get(), fd, 0))};
        // Box and program take turns on one processor: who answers need not look for another one (Linux 6.6).
        (void)::ioctl(out.get(), SECCOMP_IOW(4, std::uint64_t), std::uint64_t{1});
        return out;
    }
    return UniqueFd{};
}

} // namespace gridspace::timebox

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/unique_fd.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <sys/types.h>

namespace gridspace::timebox {

/// What becomes of a system call that the filter stops; every other call runs untouched.
enum class Treatment {
    clock,       ///< answered from the simulated clock
    sleep,       ///< held until a simulated instant
    descriptors, ///< poll, select and epoll: held until one is ready, or a simulated instant
    receive,     ///< read and recv of one descriptor: held until there is something
    send,        ///< write and send: held while there is no room
    futex,       ///< the kernel's queue of waiting threads is ours
    child,       ///< wait for a child
    signal,      ///< wait for a signal
    timer,       ///< timerfd, alarm, setitimer
    random,      ///< octets from the seed
    yield,       ///< others first
    kill,        ///< runs; waiting threads look again
    option,      ///< setsockopt: stamps of the kernel's clock are refused
    packet,      ///< packet sockets, where they are ours: made, bound, asked, their rings mapped
    refused,     ///< cannot be had in simulated time: ENOSYS or EPERM, and a message
};

struct HeldCall {
    long number;
    char const* name;
    Treatment treatment;
    int error{0}; ///< refused: what the program gets
    /// It stops only when this argument has one of these bits.
    int argument{-1};
    std::uint32_t bits{0};
};
[[nodiscard]] std::span<HeldCall const> held_calls();
[[nodiscard]] HeldCall const* find_held_call(long number);

/// Whether it is answered, or runs as it is: so it may come as a notification. Others are looked at when they come
/// back, which only ptrace shows.
[[nodiscard]] bool is_answered_at_entry(HeldCall const& call);

/// Lets the calls of held_calls() stop in this thread and all that come of it: as notifications where the kernel has
/// them (Linux 5.19) and nobody else hears this process's, or else under ptrace. Before exec; 0, or the error number.
[[nodiscard]] int install_filter();

/// Of a process that has installed it and stands: where its notifications come from; none: under ptrace.
[[nodiscard]] UniqueFd listener_of(pid_t process);

} // namespace gridspace::timebox

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

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
    kill,        ///< runs; whoever waits looks again
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

/// Lets the calls of held_calls() stop under ptrace, in this thread and all that come of it. Before exec; 0, or the
/// error number.
[[nodiscard]] int install_filter();

} // namespace gridspace::timebox

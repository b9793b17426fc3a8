// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <sys/types.h>

/// What can be done with a thread that stands still under ptrace(2). x86-64 only.
namespace gridspace::timebox {

/// A system call as the kernel gets it.
struct Call {
    long number{-1};
    std::array<std::uint64_t, 6> arguments{};
};

/// Registers are kept here while a thread stands: to be called before it runs again.
void before_it_goes_on(pid_t tid);

[[nodiscard]] Call call_of(pid_t tid);
/// At the entry of a call: it does not run, and the program gets `result` (a value, or minus an error number).
void answer(pid_t tid, std::int64_t result);
/// At the entry of a call: another one runs in its place. Only rax, rcx and r11 may differ afterwards, so what is
/// changed here has to be put back by restore() at the exit.
void replace(pid_t tid, Call const& by);
void restore(pid_t tid, Call const& original);
[[nodiscard]] std::int64_t result_of(pid_t tid); ///< at the exit of a call
/// At the exit of a call: the thread goes back to the instruction that made it.
void make_again(pid_t tid, Call const& call);

[[nodiscard]] bool read_memory(pid_t tid, std::uint64_t address, void* to, std::size_t octets);
bool write_memory(pid_t tid, std::uint64_t address, void const* from, std::size_t octets);
template <class T>
[[nodiscard]] T value_at(pid_t tid, std::uint64_t address) {
    T out{};
    (void)read_memory(tid, address, &out, sizeof out);
    return out;
}
template <class T>
void put(pid_t tid, std::uint64_t address, T const& value) {
    (void)write_memory(tid, address, &value, sizeof value);
}
[[nodiscard]] std::uint64_t stack_of(pid_t tid); ///< its top
/// Below the stack of the thread, where nothing is.
[[nodiscard]] std::uint64_t scratch_of(pid_t tid);

/// After exec: replaces the random octets that the kernel gives to every program. Where the vDSO is; 0: nowhere.
std::uint64_t prepare_image(pid_t tid, std::array<std::uint8_t, 16> const& random);
/// After exec: takes the vDSO away, through which the C library would read the clock without a call.
void take_vdso(pid_t tid);
/// At a SIGSEGV: true when it was RDTSC or RDTSCP; they are then answered with `ticks`.
[[nodiscard]] bool answer_tick_counter(pid_t tid, std::uint64_t ticks);

} // namespace gridspace::timebox

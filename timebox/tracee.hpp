// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <sys/types.h>

/// What can be done with a thread that stands still: under ptrace(2), or in a call that came as a notification of
/// seccomp(2), which costs half as much and can only be answered, or run as it is. x86-64 only.
namespace gridspace::timebox {

/// A system call as the kernel gets it.
struct Call {
    long number{-1};
    std::array<std::uint64_t, 6> arguments{};
};

/// Registers are kept here while a thread stands: to be called before somebody else looks at them.
void before_it_goes_on(pid_t tid);

/// Takes the notification that waits there. The thread that made the call; 0: it is gone.
[[nodiscard]] pid_t take_notification(int listener);
/// Whether it stands in a call that came so.
[[nodiscard]] bool is_notified(pid_t tid);
/// And has not left it, killed.
[[nodiscard]] bool waits_for_answer(pid_t tid);
/// What is known of it is forgotten: its number may come again.
void forget_tracee(pid_t tid);

enum class GoOn {
    run,    ///< to its next stop
    to_exit ///< to the exit of the call at whose entry it stands; not of a notified one
};
/// `signal`: to be delivered; 0: none.
void let_run(pid_t tid, GoOn how, int signal);

[[nodiscard]] Call call_of(pid_t tid);
/// At the entry of a call: it does not run, and the program gets `result` (a value, or minus an error number).
void answer(pid_t tid, std::int64_t result);
/// At the entry of a call that is not notified: another one runs in its place. Only rax, rcx and r11 may differ
/// afterwards, so what is changed here has to be put back by restore() at the exit.
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
[[nodiscard]] std::uint64_t stack_of(pid_t tid); ///< its top; not of one in a notified call

/// After exec: replaces the random octets that the kernel gives to every program. Where the vDSO is; 0: nowhere.
std::uint64_t prepare_image(pid_t tid, std::array<std::uint8_t, 16> const& random);
/// After exec: takes the vDSO away, through which the C library would read the clock without a call.
void take_vdso(pid_t tid);
/// At a SIGSEGV: true when it was RDTSC or RDTSCP; they are then answered with `ticks`.
[[nodiscard]] bool answer_tick_counter(pid_t tid, std::uint64_t ticks);

} // namespace gridspace::timebox

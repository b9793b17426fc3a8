// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/unique_fd.hpp"

#include <string>

namespace gridspace {

/// May this process give itself SCHED_FIFO at this priority? Tries it on a child, so that nothing changes here.
[[nodiscard]] bool may_schedule_fifo(int priority);

/// The calling process under SCHED_FIFO; threads and programs that it starts inherit it. Safe between fork and exec.
/// False when the system does not permit it.
bool schedule_fifo(int priority) noexcept;

/// The calling thread one step below the rest of its process, where that is under SCHED_FIFO; nothing otherwise. For
/// the thread that computes: those that move its data must not wait for it to sleep, and it may be late.
void step_below_the_others() noexcept;

/// "SCHED_FIFO 45" or "SCHED_OTHER": what the calling thread runs under.
[[nodiscard]] std::string scheduling_text();

/// All memory of the process, present and future, is kept from being paged out. Only where that cannot fail later: with
/// an unlimited RLIMIT_MEMLOCK, or with CAP_IPC_LOCK of the machine itself. Elsewhere mlockall would succeed now, and
/// an allocation fail in the middle of a run. Returns why not; empty when it is locked.
[[nodiscard]] std::string lock_memory();

/// While what this returns is open, idle processors do not go to sleep, as cyclictest(8) has it: to wake one up takes
/// up to 0.1 ms by its C-states, and in a virtual machine the way to the host and back. It is a request to the kernel
/// for a wake-up latency (PM QoS, /dev/cpu_dma_latency), for all processors of the machine.
[[nodiscard]] Result<UniqueFd> keep_processors_awake();

} // namespace gridspace

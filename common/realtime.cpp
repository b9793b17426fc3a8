// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/realtime.hpp"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gridspace {
namespace {

/// A capability counts only in the machine's own user namespace: in one of our own the set is full and worth nothing
/// here.
bool in_initial_user_namespace() {
    std::ifstream map{"/proc/self/uid_map"};
    std::uint64_t inside = 1, outside = 1, count = 0;
    map >> inside >> outside >> count;
    return inside == 0 && outside == 0 && count == 4294967295U;
}

bool has_capability(unsigned bit) {
    std::ifstream status{"/proc/self/status"};
    for (std::string word; status >> word;) {
        if (word == "CapEff:") {
            std::uint64_t mask = 0;
            status >> std::hex >> mask;
            return (mask >> bit & 1U) != 0;
        }
    }
    return false;
}

} // namespace

bool schedule_fifo(int priority) noexcept {
    sched_param parameters{};
    parameters.sched_priority = priority;
    return ::sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
}

bool may_schedule_fifo(int priority) {
    pid_t const child = ::fork();
    if (child == 0) {
        ::_exit(schedule_fifo(priority) ? 0 : 1);
    }
    int status = 1;
    if (child < 0) {
        return false;
    }
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

void step_below_the_others() noexcept {
    sched_param parameters{};
    if (::sched_getscheduler(0) == SCHED_FIFO && ::sched_getparam(0, &parameters) == 0 &&
        parameters.sched_priority > 1) {
        --parameters.sched_priority;
        ::sched_setscheduler(0, SCHED_FIFO, &parameters); // of this thread alone
    }
}

std::string scheduling_text() {
    sched_param parameters{};
    ::sched_getparam(0, &parameters);
    return ::sched_getscheduler(0) == SCHED_FIFO ? fmt::format("SCHED_FIFO {}", parameters.sched_priority)
                                                 : "SCHED_OTHER";
}

std::string lock_memory() {
    constexpr unsigned kIpcLock = 14; // CAP_IPC_LOCK
    rlimit limit{};
    ::getrlimit(RLIMIT_MEMLOCK, &limit);
    if (limit.rlim_cur != RLIM_INFINITY && !(in_initial_user_namespace() && has_capability(kIpcLock))) {
        return fmt::format("RLIMIT_MEMLOCK is {} kB and not unlimited, and there is no CAP_IPC_LOCK",
                           limit.rlim_cur / 1024);
    }
    // On fault: the stacks of a dozen threads are mostly never touched.
    return ::mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0 ? ""
                                                                   : fmt::format("mlockall: {}", std::strerror(errno));
}

Result<UniqueFd> keep_processors_awake() {
    std::string driver, governor;
    std::ifstream{"/sys/devices/system/cpu/cpuidle/current_driver"} >> driver;
    std::ifstream{"/sys/devices/system/cpu/cpuidle/current_governor"} >> governor;
    if (driver == "none") {
        return fail(ExitCode::environment, "the kernel has no driver for idle processors (cpuidle), and halts them",
                    "in a guest, with the module cpuidle_haltpoll");
    }
    // haltpoll is for guests: their only sleep is the way to the host, and 0 alone keeps them from it. Elsewhere the
    // lightest sleep (C1) may be.
    std::int32_t const latency_us = governor == "haltpoll" ? 0 : 2;
    UniqueFd device{::open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC)};
    if (!device || ::write(device.get(), &latency_us, sizeof latency_us) != sizeof latency_us) {
        return fail(ExitCode::environment, fmt::format("/dev/cpu_dma_latency: {}", std::strerror(errno)),
                    "as root, or with permission to write to it");
    }
    return device;
}

} // namespace gridspace

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/doctor/wakeup_latency.hpp"

#include "common/nearest_rank.hpp"
#include "common/realtime.hpp"
#include "common/sleep_until.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <fmt/format.h>
#include <fstream>
#include <sched.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

constexpr int kPriority = 45; // of the simulator

/// What the child leaves for its parent, in memory of both; the times stand behind it.
struct Shared {
    double* late_us;
    bool done;
    int processor;
    char refused[256];
};

std::int64_t now_ns() {
    timespec t{};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * 1'000'000'000LL + t.tv_nsec;
}

int stay_on_one() {
    std::string list;
    std::ifstream{"/sys/devices/system/cpu/isolated"} >> list;
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    int processor = last_processor(list);
    if (processor < 0 && ::sched_getaffinity(0, sizeof allowed, &allowed) == 0) {
        for (int i = 0; i < CPU_SETSIZE; ++i) {
            processor = CPU_ISSET(i, &allowed) ? i : processor;
        }
    }
    CPU_ZERO(&allowed);
    CPU_SET(static_cast<unsigned>(std::max(processor, 0)), &allowed);
    return ::sched_setaffinity(0, sizeof allowed, &allowed) == 0 ? processor : -1;
}

/// What the way asks for; why it cannot be had, or empty.
std::string prepare(Waiting waiting, Shared& shared) {
    if (waiting >= Waiting::fifo && !schedule_fifo(kPriority)) {
        return "SCHED_FIFO is not permitted: `rtprio` in /etc/security/limits.conf";
    }
    if (waiting >= Waiting::locked) {
        if (std::string why = lock_memory(); !why.empty()) {
            return why;
        }
    }
    if (waiting >= Waiting::one_core) {
        shared.processor = stay_on_one();
        if (shared.processor < 0) {
            return fmt::format("no processor to stay on: {}", std::strerror(errno));
        }
    }
    if (waiting == Waiting::awake) { // who polls does not sleep anyway
        auto kept = keep_processors_awake();
        if (!kept) {
            return kept.error().message;
        }
        (void)kept->release(); // open until the measuring process ends
    }
    return {};
}

void wait_until(std::int64_t instant_ns, bool polling) {
    if (polling) {
        while (now_ns() < instant_ns) {
        }
        return;
    }
    sleep_until(instant_ns);
}

void measure(Waiting waiting, std::int64_t period_ns, std::span<double> late_us) {
    std::int64_t instant = now_ns() + period_ns;
    for (double& late : late_us) {
        wait_until(instant, waiting == Waiting::polling);
        std::int64_t const now = now_ns();
        late = static_cast<double>(now - instant) / 1e3;
        instant += period_ns;
        if (now > instant) { // late by more than a period: one late wake-up, not all that it covered
            instant += (now - instant) / period_ns * period_ns + period_ns;
        }
    }
}

} // namespace

double WakeupLatency::percentile_us(double share) const {
    return nearest_rank(late_us, share);
}

std::size_t WakeupLatency::later_than(double limit_us) const {
    return static_cast<std::size_t>(late_us.end() - std::upper_bound(late_us.begin(), late_us.end(), limit_us));
}

Result<WakeupLatency> measure_wakeups(Waiting waiting, std::chrono::nanoseconds period, std::size_t count) {
    std::size_t const size = sizeof(Shared) + count * sizeof(double);
    void* const memory =
        ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_POPULATE, -1, 0);
    if (memory == MAP_FAILED) {
        return fail(ExitCode::environment, fmt::format("no memory for {} wake-ups", count));
    }
    auto& shared = *static_cast<Shared*>(memory);
    shared.processor = -1;
    shared.late_us = reinterpret_cast<double*>(&shared + 1);
    pid_t const child = ::fork();
    if (child == 0) {
        std::string const why = prepare(waiting, shared);
        std::strncpy(shared.refused, why.c_str(), sizeof shared.refused - 1);
        if (why.empty()) {
            measure(waiting, period.count(), {shared.late_us, count});
        }
        shared.done = true;
        ::_exit(0);
    }
    while (child > 0 && ::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
    }
    WakeupLatency out;
    std::string const refused = !shared.done ? "the measuring process was ended" : shared.refused;
    if (refused.empty()) {
        out.late_us.assign(shared.late_us, shared.late_us + count);
        std::sort(out.late_us.begin(), out.late_us.end());
        out.processor = shared.processor < 0 ? "" : std::to_string(shared.processor);
    }
    ::munmap(memory, size);
    if (!refused.empty()) {
        return fail(ExitCode::environment, refused);
    }
    return out;
}

std::vector<LatenessClass> lateness_classes(std::span<double const> ascending_us) {
    std::vector<LatenessClass> out;
    std::size_t counted = 0;
    for (double from = 0, below = 1; counted < ascending_us.size(); from = below, below *= 2) {
        auto const end = std::lower_bound(ascending_us.begin(), ascending_us.end(), below);
        auto const until = static_cast<std::size_t>(end - ascending_us.begin());
        if (until > 0) {
            out.push_back({from, below, until - counted});
        }
        counted = until;
    }
    return out;
}

int last_processor(std::string const& list) {
    auto const begin = list.find_last_of("-,") + 1; // 0 where there is none: npos + 1
    return begin < list.size() ? static_cast<int>(std::strtol(list.c_str() + begin, nullptr, 10)) : -1;
}

} // namespace gridspace::launcher

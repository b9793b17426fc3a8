// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <chrono>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// How a process waits for an instant. Each is what the one before it is, and one thing more; the last one needs no
/// processor to be kept awake.
enum class Waiting {
    sleeping, ///< clock_nanosleep(2) under the ordinary scheduler
    fifo,     ///< under SCHED_FIFO
    locked,   ///< and its memory is locked
    one_core, ///< and it stays on one processor: an isolated one where the machine has any
    awake,    ///< and no processor goes to sleep
    polling,  ///< and it reads the clock until the instant has come, instead of sleeping
};
/// With its names: in JSON, and for people as a row below the others.
struct WayToWait {
    Waiting waiting;
    char const *key, *name;
};
inline constexpr WayToWait kWaysToWait[] = {
    {Waiting::sleeping, "sleeping", "sleeping"},     {Waiting::fifo, "fifo", "SCHED_FIFO"},
    {Waiting::locked, "locked", "+ memory locked"},  {Waiting::one_core, "one_core", "+ one processor"},
    {Waiting::awake, "awake", "+ processors awake"}, {Waiting::polling, "polling", "+ busy polling"}};

/// How late a process woke up for instants that follow each other at a fixed period, as cyclictest(8) measures it:
/// microseconds, ascending.
struct WakeupLatency {
    std::vector<double> late_us;
    std::string processor; ///< which one it stayed on; empty: any

    [[nodiscard]] double percentile_us(double share) const;
    [[nodiscard]] std::size_t later_than(double limit_us) const;
};

/// Measures in a process of its own, so that nothing of it stays here. The error says what the system did not permit.
[[nodiscard]] Result<WakeupLatency> measure_wakeups(Waiting waiting, std::chrono::nanoseconds period,
                                                    std::size_t count);

/// How many were late by at least `from_us` and less than `below_us`: each class is twice as wide as the one before.
struct LatenessClass {
    double from_us, below_us;
    std::size_t count;
};

/// From the first class that holds any to the last; below 1 us there is one.
[[nodiscard]] std::vector<LatenessClass> lateness_classes(std::span<double const> ascending_us);

/// A list of processors as the kernel writes it ("2-3,6"): the last, or -1 where there is none.
[[nodiscard]] int last_processor(std::string const& list);

} // namespace gridspace::launcher

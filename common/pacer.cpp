// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/pacer.hpp"

#include <algorithm>
#include <cerrno>
#include <ctime>

namespace gridspace {

void Pacer::start() { start_ = std::chrono::steady_clock::now(); }

bool Pacer::wait(double time_s, std::atomic<bool> const& stop) {
    using std::chrono::nanoseconds;
    if (!paced()) {
        return true;
    }
    auto const due = start_ + std::chrono::duration_cast<nanoseconds>(std::chrono::duration<double>{time_s / speed_});
    auto const now = std::chrono::steady_clock::now();
    if (now > due) {
        late_ = now - due;
        worst_ = std::max(worst_, late_);
        ++overruns_;
        return false;
    }
    // Slices, so that a stop at slow pace is noticed; the deadline of the last one is exact.
    constexpr std::chrono::milliseconds kSlice{200};
    for (auto at = now; at < due && !stop.load(std::memory_order_relaxed);) {
        at = std::min(due, at + kSlice);
        auto const ns = at.time_since_epoch().count();
        timespec const until{static_cast<time_t>(ns / 1'000'000'000), static_cast<long>(ns % 1'000'000'000)};
        while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
        }
    }
    late_ = std::chrono::steady_clock::now() - due;
    return true;
}

} // namespace gridspace

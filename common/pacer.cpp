// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/pacer.hpp"

#include "common/sleep_until.hpp"

#include <algorithm>

namespace gridspace {

void Pacer::start() {
    start_ = std::chrono::steady_clock::now();
}

std::int64_t Pacer::start_on_utc_second(std::atomic<bool> const& stop) {
    using namespace std::chrono;
    // The two clocks are read one after the other: of several readings, the one that was least interrupted.
    auto best = steady_clock::duration::max();
    nanoseconds second{};
    for (int i = 0; i < 5; ++i) {
        auto const before = steady_clock::now();
        nanoseconds const wall = system_clock::now().time_since_epoch();
        auto const after = steady_clock::now();
        if (after - before < best) {
            best = after - before;
            second = floor<seconds>(wall) + seconds{1};
            start_ = before + (after - before) / 2 + (second - wall);
        }
    }
    sleep_until(start_, stop);
    return second.count();
}

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
    sleep_until(due, stop);
    late_ = std::chrono::steady_clock::now() - due;
    return true;
}

/// In slices, so that a stop at slow pace is noticed; the deadline of the last one is exact.
void Pacer::sleep_until(std::chrono::steady_clock::time_point due, std::atomic<bool> const& stop) {
    constexpr std::chrono::milliseconds kSlice{200};
    for (auto at = std::chrono::steady_clock::now(); at < due && !stop.load(std::memory_order_relaxed);) {
        at = std::min(due, at + kSlice);
        gridspace::sleep_until(at.time_since_epoch().count());
    }
}

} // namespace gridspace

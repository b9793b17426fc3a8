// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <ctime>
#include <sys/time.h>

namespace gridspace::timebox {

/// The clocks of a program in simulated time. They begin together, go on by `kReadNs` with each look (so that a loop
/// that waits by looking goes on), and otherwise only by elapse_to(). Nanoseconds since the start.
class SimulatedClock {
  public:
    static constexpr std::int64_t kReadNs = 100;
    explicit SimulatedClock(std::int64_t epoch_unix_s) : epoch_ns_{epoch_unix_s * 1'000'000'000} {}

    [[nodiscard]] std::int64_t now_ns() const { return now_ns_; }
    void elapse_to(std::int64_t ns) { now_ns_ = ns > now_ns_ ? ns : now_ns_; }
    void look() { now_ns_ += kReadNs; }

    /// What `clock` shows when it is now; clocks of processor time show the time since the start, too.
    [[nodiscard]] std::int64_t reading_ns(clockid_t clock) const { return now_ns_ + offset_ns(clock); }
    /// When `clock` shows that.
    [[nodiscard]] std::int64_t when(clockid_t clock, std::int64_t reading_ns) const {
        return reading_ns - offset_ns(clock);
    }

  private:
    static constexpr std::int64_t kTaiNs = 37'000'000'000; ///< ahead of UTC, since 2017
    [[nodiscard]] std::int64_t offset_ns(clockid_t clock) const {
        bool const wall = clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE || clock == CLOCK_REALTIME_ALARM;
        return wall ? epoch_ns_ : clock == CLOCK_TAI ? epoch_ns_ + kTaiNs : 0;
    }

    std::int64_t epoch_ns_;
    std::int64_t now_ns_{0};
};

[[nodiscard]] inline timespec to_timespec(std::int64_t ns) {
    return {ns / 1'000'000'000, ns % 1'000'000'000};
}
/// Longer than a time may be: "for ever". As the kernel does, so that no sum overflows.
inline constexpr std::int64_t kLongestNs = INT64_MAX / 2;
[[nodiscard]] inline std::int64_t to_ns(std::int64_t seconds, std::int64_t ns) {
    return seconds >= kLongestNs / 1'000'000'000 ? kLongestNs : seconds * 1'000'000'000 + ns;
}
[[nodiscard]] inline std::int64_t to_ns(timespec const& t) {
    return to_ns(t.tv_sec, t.tv_nsec);
}
[[nodiscard]] inline std::int64_t to_ns(timeval const& t) {
    return to_ns(t.tv_sec, std::int64_t{t.tv_usec} * 1000);
}

} // namespace gridspace::timebox

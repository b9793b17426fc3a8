// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <limits>

namespace gridspace::gateways {

/// When a frame came, on the monotonic clock that the state machines live by in real time, whenever it is read: the
/// kernel's receive stamp says how old it is. The stamp is of the machine's UTC, which may be set: so only the age at
/// the moment of reading is believed, and nothing that contradicts what is known. Arrivals never go back, lie before
/// the reading, and behind the last look that found nothing.
class ArrivalClock {
  public:
    /// Both clocks at one moment.
    struct Reading {
        std::int64_t steady_ns{0}, utc_ns{0};
    };
    /// Who is preempted between the two clocks takes the distance of that for age: the best of a few readings counts.
    [[nodiscard]] static Reading read() noexcept {
        Reading best;
        std::int64_t shortest = std::numeric_limits<std::int64_t>::max();
        for (int attempt = 0; attempt < 3 && shortest > 2'000; ++attempt) {
            std::int64_t const before = steady_ns();
            timespec utc{};
            clock_gettime(CLOCK_REALTIME, &utc);
            std::int64_t const took = steady_ns() - before;
            if (took < shortest) {
                shortest = took;
                best = {before, utc.tv_sec * 1'000'000'000LL + utc.tv_nsec};
            }
        }
        return best;
    }
    [[nodiscard]] static std::int64_t steady_ns() noexcept {
        return std::chrono::steady_clock::now().time_since_epoch().count();
    }

    explicit ArrivalClock(std::int64_t opened_ns) noexcept : earliest_ns_{opened_ns} {}

    /// A look that began then found nothing: what is read from now on has come later.
    void nothing_at(std::int64_t steady_ns) noexcept { earliest_ns_ = std::max(earliest_ns_, steady_ns); }

    /// The arrival of the next frame; the clocks were read behind it. Without a stamp (0) it came when it was read.
    [[nodiscard]] std::int64_t arrival(std::int64_t stamp_ns, Reading now) noexcept {
        std::int64_t const age_ns = stamp_ns == 0 ? 0 : std::max<std::int64_t>(0, now.utc_ns - stamp_ns);
        earliest_ns_ = std::max(earliest_ns_, now.steady_ns - age_ns);
        return earliest_ns_;
    }

  private:
    std::int64_t earliest_ns_;
};

} // namespace gridspace::gateways

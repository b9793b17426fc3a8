// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>

namespace gridspace {

/// How long somebody has been waited for, by somebody who looks at least twice a second. When the looks are further
/// apart, this process did not run either (its machine was paused, or is very busy), and of that time only half a
/// second counts.
class WaitedTime {
  public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::milliseconds kLook{500};

    explicit WaitedTime(Clock::time_point now = Clock::now()) : last_{now} {}
    void restart(Clock::time_point now = Clock::now()) {
        last_ = now;
        sum_ = {};
    }
    /// So far.
    std::chrono::duration<double> look(Clock::time_point now = Clock::now()) {
        sum_ += std::min<Clock::duration>(now - last_, kLook);
        last_ = now;
        return sum_;
    }

  private:
    Clock::time_point last_;
    Clock::duration sum_{};
};

} // namespace gridspace

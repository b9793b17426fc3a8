// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>

namespace gridspace::launcher {

/// When the next of many processes may be started. Processes that look for each other all at the same time flood those
/// for whom all look: the simulator and the recorder then lose most datagrams, everything is sent again, and 200
/// processes do not come to an end. So only some look at a time, and another begins when one of them has found what it
/// needs. Those that are started may also need one that is not: when nobody gets on, more may begin.
class GradualStart {
  public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::size_t kAtOnce = 32;
    static constexpr std::chrono::seconds kStandstill{1};

    explicit GradualStart(Clock::time_point now = Clock::now()) : advanced_{now} {}
    /// `looking`: processes that are started and not matched yet; `matched`: those that have been.
    [[nodiscard]] bool has_room(std::size_t looking, std::size_t matched, Clock::time_point now = Clock::now()) {
        if (matched > matched_) {
            matched_ = matched;
            advanced_ = now;
        } else if (now - advanced_ >= kStandstill) {
            most_ += kAtOnce;
            advanced_ = now;
        }
        return looking < most_;
    }

  private:
    std::size_t most_{kAtOnce}, matched_{0};
    Clock::time_point advanced_;
};

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/waited_time.hpp"

#include <cstddef>

namespace gridspace::bus {

/// How long a start may stand still. Not how long it may take: two hundred processes beside a busy machine take their
/// time, and as long as more of them are there than ever before, nobody is missing. To be asked at least twice a
/// second.
class StartPatience {
  public:
    using Clock = WaitedTime::Clock;
    /// 0 seconds: no end.
    explicit StartPatience(double seconds, Clock::time_point now = Clock::now()) : seconds_{seconds}, still_{now} {}
    /// `present`: how much of what is waited for is there. What goes and comes back is no progress.
    [[nodiscard]] bool over(std::size_t present, Clock::time_point now = Clock::now()) {
        if (present > most_) {
            most_ = present;
            still_.restart(now);
        }
        return seconds_ > 0 && still_.look(now).count() >= seconds_;
    }

  private:
    double seconds_;
    std::size_t most_{0};
    WaitedTime still_;
};

} // namespace gridspace::bus

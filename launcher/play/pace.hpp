// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/wire/live.hpp"

#include <algorithm>
#include <cstdint>

namespace gridspace::play {

/// The recorded clock against the monotonic one.
class Pace {
  public:
    /// `first_ns`: the recorded instant that is now.
    Pace(std::int64_t first_ns, double rate) : first_ns_{first_ns}, start_ns_{wire::monotonic_ns()}, rate_{rate} {}
    [[nodiscard]] std::int64_t due(std::int64_t recorded_ns) const {
        return rate_ > 0 ? start_ns_ + static_cast<std::int64_t>(static_cast<double>(recorded_ns - first_ns_) / rate_)
                         : start_ns_;
    }
    [[nodiscard]] bool is_paced() const { return rate_ > 0; }
    /// Returns how late it is, in nanoseconds. Early when the user has asked for the end.
    std::int64_t wait_until(std::int64_t recorded_ns) const {
        constexpr std::int64_t kLookForStop = 50'000'000;
        std::int64_t const at = due(recorded_ns);
        std::int64_t now = wire::monotonic_ns();
        while (now < at && !wire::stopped()) {
            wire::sleep_until(std::min(at, now + kLookForStop));
            now = wire::monotonic_ns();
        }
        return rate_ > 0 ? std::max<std::int64_t>(0, now - at) : 0;
    }

  private:
    std::int64_t first_ns_, start_ns_;
    double rate_;
};

} // namespace gridspace::play

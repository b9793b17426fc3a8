// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node_config.hpp"

#include <cstdint>
#include <limits>

namespace gridspace::bus {

/// Which tick of a process an instant belongs to: tick k covers (t_(k-1), t_k], t_k = k ticks, and `ahead_s` later for
/// a process whose input is complete beyond the tick.
class TickGrid {
  public:
    explicit TickGrid(ClockConfig const& clock)
        : span_{TimeBase{clock.quantum_s}.nearest(clock.tick_s)},
          ahead_{TimeBase{clock.quantum_s}.nearest(clock.ahead_s)} {}

    static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();
    [[nodiscard]] std::uint64_t tick_of(SimTime t) const {
        std::int64_t const quanta = t.quanta - ahead_.quanta;
        return quanta <= 0 ? 0 : static_cast<std::uint64_t>((quanta + span_.quanta - 1) / span_.quanta);
    }
    [[nodiscard]] SimTime end_of(std::uint64_t tick) const {
        return {static_cast<std::int64_t>(tick) * span_.quanta + ahead_.quanta};
    }

  private:
    SimSpan span_, ahead_;
};

} // namespace gridspace::bus

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node_config.hpp"

#include <cstdint>
#include <limits>

namespace gridspace::bus {

/// Which tick an instant belongs to: tick k covers (t_(k-1), t_k], t_k = k ticks.
class TickGrid {
  public:
    explicit TickGrid(ClockConfig const& clock) : span_{TimeBase{clock.quantum_s}.nearest(clock.tick_s)} {}

    static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();
    [[nodiscard]] std::uint64_t tick_of(SimTime t) const {
        return t.quanta <= 0 ? 0 : static_cast<std::uint64_t>((t.quanta + span_.quanta - 1) / span_.quanta);
    }
    [[nodiscard]] SimTime end_of(std::uint64_t tick) const { return {static_cast<std::int64_t>(tick) * span_.quanta}; }

  private:
    SimSpan span_;
};

} // namespace gridspace::bus

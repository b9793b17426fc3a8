// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <optional>
#include <vector>

namespace gridspace::sdk {

/// When an agent wants to be called although nothing comes. Timers have numbers from 0 on; that of one which will never
/// be due again is given to the next.
class Timers {
  public:
    /// At whole multiples of `period` (at least a quantum); `first` or before it is the first.
    int every(SimSpan period, SimTime first);
    int at(SimTime time);
    /// False when there is no such timer.
    bool cancel(int timer);

    struct Due {
        SimTime time;
        int timer;
    };
    /// The earliest, of one time the lowest number.
    [[nodiscard]] std::optional<Due> next() const;
    /// It has been due: a period later again, or never.
    void passed(int timer);
    /// Periodic ones: goes on to the first multiple for which `is_over` is false.
    template <class IsOver>
    void skip(IsOver const& is_over) {
        for (Timer& timer : timers_) {
            while (timer.time && timer.period.quanta > 0 && is_over(*timer.time, timer.period)) {
                timer.time = *timer.time + timer.period;
            }
        }
    }

  private:
    int add(SimTime time, SimSpan period);
    struct Timer {
        std::optional<SimTime> time; ///< nothing: never again
        SimSpan period;              ///< 0: once
    };
    std::vector<Timer> timers_;
};

} // namespace gridspace::sdk

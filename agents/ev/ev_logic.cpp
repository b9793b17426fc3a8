// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/ev/ev_logic.hpp"

#include <algorithm>

namespace gridspace::agents {

double requested_current_a(EvParams const& p, double soc_percent, double elapsed_h) {
    double const missing = (p.soc_target_percent - soc_percent) / 100;
    if (!(missing > 0)) { // also when the measurement is not a number
        return 0;
    }
    double const hours = p.time_base == EvParams::TimeBase::fixed
                             ? p.requested_h
                             : std::max(p.requested_h - elapsed_h, p.min_remaining_h);
    return std::min(missing * p.capacity_kwh * 1e3 / (hours * p.battery_v), p.rated_current_a);
}

} // namespace gridspace::agents

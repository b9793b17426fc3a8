// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node_config.hpp"
#include "common/time.hpp"

#include <algorithm>

namespace gridspace::bus {

/// The instant at which output to an input of `input` takes effect, for a process that works at `now`: in lockstep the
/// end of the granted tick, which is `tick` long. Who was paused finds inputs of ticks that are over; what it does
/// about them, it does now. In real time the delay is what it is, and a declared latency adds nothing.
[[nodiscard]] inline SimTime effect_time(ClockMode mode, SimTime input, SimTime now, SimSpan tick, SimSpan latency) {
    return mode == ClockMode::lockstep ? std::max(input, now - tick) + latency : now;
}

} // namespace gridspace::bus

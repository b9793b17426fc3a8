// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node.hpp"
#include "gateways/gateway/clock_follower.hpp"
#include "gateways/port/wire_clock.hpp"
#include "gateways/port/wire_port.hpp"

namespace gridspace::gateways {

/// An instant on both axes of a daemon: that of its state machines (WireClock), and simulated time.
struct Moment {
    std::int64_t ns{0};
    SimTime time;
    std::int64_t kernel_ns{0}; ///< of a frame, in real time: when the kernel received it (CLOCK_REALTIME)
    std::int64_t arrived_ns{
        0}; ///< of a frame, in real time: when it came, on the axis of `ns`, which is when it is handled

    /// The time given to a state machine of a stream: a stall of ours is not the stream's.
    [[nodiscard]] std::int64_t arrival_ns() const { return arrived_ns != 0 ? arrived_ns : ns; }
};

/// What the parts of a gateway share.
struct GatewayContext {
    bus::Node& node;
    WirePort& port; ///< of the process's own thread
    WireConfig const& wire;
    WireClock clock;
    SimSpan latency;
    ClockFollower const* follower{nullptr}; ///< what smpSynch is, instead of what the stream says; may be none

    /// Nanoseconds of the latency on the axis of the state machines; in real time it is what it is.
    [[nodiscard]] std::int64_t latency_ns() const {
        return node.lockstep() ? node.time_base().nanoseconds(SimTime{latency.quanta}) : 0;
    }
};

} // namespace gridspace::gateways

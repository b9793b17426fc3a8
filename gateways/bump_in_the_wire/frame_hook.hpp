// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace gridspace::gateways {

/// A frame of sampled values or GOOSE on its way through a bump in the wire.
struct PassingFrame {
    std::span<std::uint8_t const> octets; ///< from the destination address on, VLAN tag included
    std::int64_t time_ns{
        0}; ///< simulated time: when it was sent (lockstep) or came in (real time; negative before the start)
};

/// Takes what goes on.
class FrameOutput {
  public:
    virtual ~FrameOutput() = default;
    /// Sends a frame on, `delay_ns` (>= 0, simulated) after the frame or the moment that the hook was called for. In
    /// lockstep the time is rounded up to the time grid of the run. The octets are copied.
    virtual void send(std::span<std::uint8_t const> octets, std::int64_t delay_ns = 0) = 0;
};

/// What becomes of the frames of one direction: passed on as they are, changed, delayed, several times, or not at all.
/// Called in the order of time; in lockstep on the process's own thread, in real time on the bump's own.
class FrameHook {
  public:
    virtual ~FrameHook() = default;
    /// A frame has come. Nothing sent means that it is dropped; where frames are only heard, what is sent goes nowhere.
    virtual void pass(PassingFrame const& frame, FrameOutput& out) { out.send(frame.octets); }
    /// Frames of its own: when the next one is due (simulated time), and the call at that time.
    [[nodiscard]] virtual std::optional<std::int64_t> due() const { return std::nullopt; }
    virtual void elapse(std::int64_t /*now_ns*/, FrameOutput& /*out*/) {}
};

} // namespace gridspace::gateways

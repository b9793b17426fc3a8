// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/sample_attack.hpp"
#include "gateways/iec61850/frame.hpp"

#include <functional>
#include <optional>
#include <span>

namespace gridspace::attacker {

using Emit = std::function<void(std::span<std::uint8_t const> frame)>; ///< a frame to be sent
using Tell = std::function<void(Label const&)>;                        ///< an altered value

/// An attack on the messages or the frames of one stream, in a cable or as a second publisher. Times are simulated,
/// in nanoseconds.
class WireAttack {
  public:
    virtual ~WireAttack() = default;
    /// A real frame. Man in the middle (`emit` given): what goes on. Otherwise it is only listened to.
    virtual void pass(iec61850::Octets frame, std::int64_t time_ns, Emit const& emit, Tell const& tell) = 0;
    /// How much later the frame that is being emitted is to be sent.
    [[nodiscard]] virtual std::int64_t delay_ns() const { return 0; }
    /// When the next frame of its own is due; and sends it.
    [[nodiscard]] virtual std::optional<std::int64_t> due() const = 0;
    virtual void elapse(std::int64_t now_ns, Emit const& emit, Tell const& tell) = 0;

    /// What it waits for has come, on another stream.
    virtual void trigger(std::int64_t now_ns) = 0;

    /// The address that forged frames come from.
    virtual void set_source(iec61850::Mac const& source) = 0;
    /// UTC of simulated time 0, before the first of the calls above; in real time it is known late.
    virtual void set_utc_base(std::int64_t /*utc_base_ns*/) {}
    [[nodiscard]] virtual std::uint64_t forged() const = 0; ///< from any thread
};

} // namespace gridspace::attacker

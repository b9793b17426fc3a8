// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/port/wire_clock.hpp"
#include "gateways/port/wire_port.hpp"
#include "timebox/box.hpp"
#include "timebox/member/member_config.hpp"

#include <memory>

namespace gridspace::timebox {

/// The frames between a program in its box and the wire of a run.
class FrameExchange {
  public:
    /// Before Node::start.
    [[nodiscard]] static Result<std::unique_ptr<FrameExchange>> open(bus::Node& node, MemberConfig const& config);

    [[nodiscard]] PacketLink link(); ///< for the box
    /// The frames of a tick, in the ledger's order.
    void bring(Box& box);
    /// The run is over: what the program still sends goes nowhere.
    void close() { over_ = true; }
    /// When a frame comes that is announced already.
    [[nodiscard]] std::optional<SimTime> next() const { return port_ == nullptr ? std::nullopt : port_->next(); }
    void maintain();

  private:
    FrameExchange(bus::Node& node, MemberConfig const& config);
    [[nodiscard]] std::string send(std::span<std::uint8_t const> frame, std::int64_t now_ns);

    MemberConfig const& config_;
    gateways::WireClock clock_;
    std::int64_t latency_ns_;
    std::unique_ptr<gateways::WirePort> port_;
    int index_{0};
    std::vector<bus::WireFrame const*> frames_;
    bool over_{false};
    SimTime free_{}; ///< IP: the cable is, for the next frame
};

} // namespace gridspace::timebox

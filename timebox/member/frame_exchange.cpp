// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/member/frame_exchange.hpp"

#include "gateways/ethernet/boxed_ip.hpp"
#include "gateways/ethernet/interface.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::timebox {

FrameExchange::FrameExchange(bus::Node& node, MemberConfig const& config)
    : config_{config}, clock_{node},
      latency_ns_{clock_.lasting(node.time_base().ceil(config.latency_us / Rational{1'000'000}), 1)} {}

Result<std::unique_ptr<FrameExchange>> FrameExchange::open(bus::Node& node, MemberConfig const& config) {
    auto out = std::unique_ptr<FrameExchange>{new FrameExchange{node, config}};
    if (config.wire.interface.empty()) {
        return out;
    }
    auto port = gateways::WirePort::open(node, config.wire, {config.sends, config.receives, true, false});
    if (!port) {
        return std::unexpected{port.error()};
    }
    out->port_ = std::move(*port);
    auto const index = ethernet::interface_index(config.wire.interface);
    if (!index) {
        return std::unexpected{index.error()};
    }
    out->index_ = static_cast<int>(*index);
    return out;
}

PacketLink FrameExchange::link() {
    PacketLink out;
    out.index = index_;
    out.name = config_.wire.interface;
    if (port_ != nullptr) {
        out.mac = port_->mac().octets;
        out.ip = config_.ip;
    }
    if (!config_.reads.empty() || !config_.writes.empty()) { // it speaks DDS with the door alone
        constexpr std::uint32_t kLoopback = 0x7F000001;
        out.index = out.name.empty() ? 1 : out.index;
        out.name = out.name.empty() ? "lo" : out.name;
        out.ip = IpLink{kLoopback, 8, {0x02, 0x47, 0x53, 0x80, 0, 0}, {}};
    }
    out.send = [this](std::span<std::uint8_t const> frame, std::int64_t now_ns) { return send(frame, now_ns); };
    return out;
}

std::string FrameExchange::send(std::span<std::uint8_t const> frame, std::int64_t now_ns) {
    std::uint16_t const ethertype = iec61850::ethertype_of(frame);
    if (ethertype == ethernet::kIpEthertype && !config_.ip) {
        return {}; // multicast, which nobody else hears
    }
    if (std::find(config_.sends.begin(), config_.sends.end(), ethertype) == config_.sends.end()) {
        return fmt::format("a frame of ethertype {:#06x}, which its `sends:` does not declare", ethertype);
    }
    if (over_) {
        return {};
    }
    SimTime at = clock_.at_or_after(now_ns + latency_ns_);
    if (ethertype == ethernet::kIpEthertype) { // the order in which they leave is seen, so no two leave at one instant
        at = std::max(at, free_);
        free_ = SimTime{at.quanta + 1};
    }
    port_->send(frame, at);
    return {};
}

void FrameExchange::bring(Box& box) {
    frames_.clear();
    for (std::uint16_t const ethertype : config_.receives) {
        auto const due = port_->take(ethertype);
        frames_.insert(frames_.end(), due.begin(), due.end());
    }
    std::sort(frames_.begin(), frames_.end(), [](bus::WireFrame const* a, bus::WireFrame const* b) {
        return a->time != b->time ? a->time < b->time : a->octets < b->octets;
    });
    for (bus::WireFrame const* frame : frames_) {
        box.arrives(clock_.of(frame->time), frame->octets);
    }
}

void FrameExchange::maintain() {
    if (port_ != nullptr) {
        port_->maintain();
    }
}

} // namespace gridspace::timebox

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/port/frame_sender.hpp"

#include "gateways/port/arrival_clock.hpp"

#include <algorithm>

namespace gridspace::gateways {

Result<FrameSender> FrameSender::open(WireConfig const& wire, std::atomic<std::uint16_t>& sequence,
                                      FrameAuthentication* authentication) {
    FrameSender out{sequence, authentication};
    for (WirePlace const* place : wire.places()) {
        ethernet::PortOptions options;
        options.interface = place->interface;
        options.receive = false;
        auto port = ethernet::Port::open(options);
        if (!port) {
            return std::unexpected{port.error()};
        }
        out.ports_.push_back(std::move(*port));
    }
    out.routed_ = routed_streams(wire, out.ports_.front().mac());
    return out;
}

std::span<iec61850::Octets const> FrameSender::with_codes(std::span<iec61850::Octets const> frames) {
    if (authentication_ == nullptr) {
        return frames;
    }
    std::int64_t const utc_ns = ArrivalClock::read().utc_ns;
    signed_.resize(std::max(signed_.size(), frames.size()));
    signed_batch_.clear();
    for (std::size_t i = 0; i < frames.size(); ++i) {
        signed_batch_.push_back(authentication_->sign(frames[i], utc_ns, signed_[i]));
    }
    return signed_batch_;
}

std::span<iec61850::Octets const> FrameSender::on_the_wire(std::span<iec61850::Octets const> frames) {
    if (routed_.empty()) {
        return frames;
    }
    datagrams_.resize(std::max(datagrams_.size(), frames.size()));
    routed_batch_.clear();
    for (std::size_t i = 0; i < frames.size(); ++i) {
        routed_batch_.push_back(routed_.on_the_wire(frames[i], datagrams_[i]));
    }
    return routed_batch_;
}

void FrameSender::send(std::span<iec61850::Octets const> given) {
    auto const frames = on_the_wire(with_codes(given));
    if (ports_.size() == 1) {
        ports_.front().send(frames);
        return;
    }
    auto const first = sequence_->fetch_add(static_cast<std::uint16_t>(frames.size()), std::memory_order_relaxed);
    for (std::size_t k = 0; k < ports_.size(); ++k) {
        auto& buffers = with_trailer_[k];
        buffers.resize(std::max(buffers.size(), frames.size()));
        batch_.clear();
        for (std::size_t i = 0; i < frames.size(); ++i) {
            prp::write_with_trailer(frames[i], {static_cast<std::uint16_t>(first + i), prp::kLans[k]}, buffers[i]);
            batch_.emplace_back(buffers[i]);
        }
        ports_[k].send(batch_);
    }
}

void FrameSender::maintain() {
    for (ethernet::Port& port : ports_) {
        port.maintain();
    }
}

} // namespace gridspace::gateways

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/port/wire_port.hpp"

#include "common/log.hpp"
#include "common/wall_clock_file.hpp"
#include "gateways/ethernet/boxed_ip.hpp"
#include "gateways/port/wire_clock.hpp"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>

namespace gridspace::gateways {

Result<std::unique_ptr<WirePort>> WirePort::open(bus::Node& node, WireConfig const& config,
                                                 Ethertypes const& ethertypes) {
    auto port = std::unique_ptr<WirePort>{new WirePort{node}};
    for (WirePlace const* place : config.places()) {
        auto link = Attachment::open(node, *place, ethertypes.send, ethertypes.receive);
        if (!link) {
            return std::unexpected{link.error()};
        }
        port->links_.push_back(std::move(*link));
    }
    if (ethertypes.authenticate) {
        auto const start = node.lockstep() ? std::optional{WireClock{node}.utc_ns(0)} : std::nullopt;
        auto authentication = FrameAuthentication::create(config.streams, start);
        if (!authentication) {
            return std::unexpected{authentication.error()};
        }
        port->authentication_ = std::move(*authentication);
    }
    port->open_datagrams_ = ethertypes.open_datagrams;
    port->routed_ = routed_streams(config, port->mac());
    for (streams::Stream const& stream : config.streams) {
        if (stream.udp && !node.lockstep() && !ethertypes.receive.empty()) {
            for (WirePlace const* place : config.places()) {
                port->groups_.join(place->interface, stream.udp->group);
            }
        }
    }
    if (node.lockstep()) { // what is sent to it is in the ring when its ledger comes: nobody has to wake up for it
        node.exchange_frames_with([raw = port.get()] { raw->drain(); }, [raw = port.get()] { raw->flush(); });
    }
    return port;
}

WirePort::~WirePort() {
    if (authentication_ != nullptr) {
        std::string const process = node_.config().process, prefix = "authentication." + process + ".";
        write_wall_clock(process + ".authentication", {{prefix + "sign_us_", &authentication_->signing()},
                                                       {prefix + "check_us_", &authentication_->checking()}});
    }
    if (links_.size() < 2) {
        return;
    }
    for (prp::Lan const lan : prp::kLans) {
        prp::LanCounters const& n = discard_.counters(lan);
        log::info(
            "PRP, network {}: {} frames received, {} of them before their other copy, {} of singly attached nodes{}",
            lan == prp::Lan::a ? 'A' : 'B', n.received, n.first, n.alone,
            n.wrong_lan > 0 ? fmt::format("; {} say that they are of the other network", n.wrong_lan) : "");
    }
}

void WirePort::drain() {
    for (auto const& link : links_) {
        link->drain();
    }
}

std::optional<SimTime> WirePort::next() const {
    std::optional<SimTime> out;
    for (auto const& link : links_) {
        if (auto const time = link->next()) {
            out = out ? std::min(*out, *time) : *time;
        }
    }
    return out;
}

std::uint64_t WirePort::dropped() const {
    std::uint64_t out = 0;
    for (auto const& link : links_) {
        out += link->dropped();
    }
    return out;
}

std::span<bus::WireFrame const* const> WirePort::take_redundant(std::uint16_t ethertype) {
    arrivals_.clear();
    for (std::size_t k = 0; k < links_.size(); ++k) {
        for (bus::WireFrame const* const frame : links_[k]->take(ethertype)) {
            arrivals_.push_back({frame, prp::kLans[k]});
        }
    }
    WireClock const clock{node_};
    auto const time_ns = [&](Arrival const& a) {
        return clock.simulated() ? clock.of(a.frame->time) : a.frame->arrived_ns;
    };
    std::ranges::stable_sort(arrivals_, {}, time_ns);
    firsts_.clear();
    for (Arrival const& arrival : arrivals_) {
        if (discard_.accept(octets(*arrival.frame), arrival.lan, time_ns(arrival))) {
            firsts_.push_back(arrival.frame);
        }
    }
    return firsts_;
}

/// A datagram that cannot be read stays what it is: who takes it counts what it cannot decode.
std::span<bus::WireFrame const* const> WirePort::opened(std::span<bus::WireFrame const* const> due,
                                                        std::uint16_t ethertype) {
    auto const in_datagram = [](bus::WireFrame const* frame) {
        return iec61850::ethertype_of(octets(*frame)) == ethernet::kIpEthertype;
    };
    if (!open_datagrams_ || std::ranges::none_of(due, in_datagram)) {
        return due;
    }
    opened_.clear();
    auto& messages = messages_[ethertype];
    std::size_t used = 0;
    for (bus::WireFrame const* const frame : due) {
        iec61850::Octets const outer = octets(*frame);
        if (!in_datagram(frame) || !iec61850::decode_routable(iec61850::routable_payload(outer), session_)) {
            opened_.push_back(frame);
            continue;
        }
        for (iec61850::RoutablePayload const& payload : session_.view()) {
            if ((payload.goose ? iec61850::kGooseEthertype : iec61850::kSvEthertype) != ethertype) {
                continue;
            }
            if (used == messages.size()) {
                messages.push_back(std::make_unique<bus::WireFrame>());
            }
            bus::WireFrame& message = *messages[used++];
            iec61850::as_ethernet(outer, payload, message_);
            auto const bytes = std::as_bytes(std::span{message_});
            message.octets.assign(bytes.begin(), bytes.end());
            message.time = frame->time;
            message.kernel_ns = frame->kernel_ns;
            message.arrived_ns = frame->arrived_ns;
            message.port = frame->port;
            opened_.push_back(&message);
        }
    }
    return opened_;
}

std::span<bus::WireFrame const* const> WirePort::take(std::uint16_t ethertype) {
    auto const due =
        opened(links_.size() == 1 ? links_.front()->take(ethertype) : take_redundant(ethertype), ethertype);
    if (authentication_ == nullptr) {
        return due;
    }
    genuine_.clear();
    WireClock const clock{node_};
    for (bus::WireFrame const* const frame : due) {
        std::int64_t const utc_ns = clock.utc_at(clock.simulated() ? clock.of(frame->time) : frame->arrived_ns);
        if (authentication_->accept(octets(*frame), utc_ns, frame->time)) {
            genuine_.push_back(frame);
        }
    }
    return genuine_;
}

void WirePort::send_redundantly(std::span<std::uint8_t const> frame, SimTime at) {
    std::uint16_t const sequence = sequence_.fetch_add(1, std::memory_order_relaxed);
    for (std::size_t k = 0; k < links_.size(); ++k) {
        prp::write_with_trailer(frame, {sequence, prp::kLans[k]}, with_trailer_);
        links_[k]->send(with_trailer_, at);
    }
}

void WirePort::send(std::span<std::uint8_t const> frame, SimTime at) {
    std::unique_lock sending{sending_, std::defer_lock};
    if (authentication_ != nullptr || links_.size() > 1 || !routed_.empty()) {
        sending.lock(); // samples that are paced have a thread of their own
    }
    if (authentication_ != nullptr) {
        WireClock const clock{node_};
        frame = authentication_->sign(frame, clock.utc_at(clock.simulated() ? clock.of(at) : clock.now()), signed_);
    }
    frame = routed_.on_the_wire(frame, datagram_);
    if (links_.size() > 1) {
        send_redundantly(frame, at);
    } else {
        links_.front()->send(frame, at);
    }
    if (!node_.lockstep()) {
        return;
    }
    constexpr std::size_t kMostOctets = 256U << 10U;
    outgoing_ += frame.size();
    if (outgoing_ > kMostOctets) {
        flush();
    }
}

void WirePort::flush() {
    outgoing_ = 0;
    bool taken = false;
    for (auto const& link : links_) {
        taken = link->flush() || taken;
    }
    if (!taken) { // of two networks one is enough
        node_.fail_with({ExitCode::environment,
                         fmt::format("the kernel did not take a frame on '{}'", links_.front()->interface()),
                         "is the link up?"});
    }
}

void WirePort::maintain() {
    if (auto const now = std::chrono::steady_clock::now(); now - maintained_ > std::chrono::milliseconds{200}) {
        maintained_ = now;
        for (auto const& link : links_) {
            link->maintain();
        }
    }
}

} // namespace gridspace::gateways

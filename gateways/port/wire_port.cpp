// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/port/wire_port.hpp"

#include "common/log.hpp"
#include "gateways/ethernet/boxed_ip.hpp"
#include "gateways/ethernet/interface.hpp"
#include "gateways/port/wire_clock.hpp"

#include <chrono>
#include <fmt/format.h>

namespace gridspace::gateways {
namespace {

constexpr std::size_t kMaxWaiting = 32U << 20U; ///< octets of one ethertype: four seconds of ten streams

} // namespace

Result<std::unique_ptr<WirePort>> WirePort::open(bus::Node& node, WireConfig const& config,
                                                 Ethertypes const& ethertypes) {
    constexpr std::chrono::seconds kPatience{30}; // as for the addresses of the networks
    ethernet::wait_for_interface(config.interface, kPatience);
    ethernet::PortOptions options;
    options.interface = config.interface;
    options.receive = false;
    auto sender = ethernet::Port::open(options);
    if (!sender) {
        return std::unexpected{sender.error()};
    }
    auto port = std::unique_ptr<WirePort>{new WirePort{node, std::move(*sender)}};
    if (ethertypes.authenticate) {
        auto const start = node.lockstep() ? std::optional{WireClock{node}.utc_ns(0)} : std::nullopt;
        auto authentication = FrameAuthentication::create(config.streams, start);
        if (!authentication) {
            return std::unexpected{authentication.error()};
        }
        port->authentication_ = std::move(*authentication);
    }
    for (std::uint16_t const ethertype : ethertypes.send) {
        port->writers_[ethertype] = std::make_unique<bus::WireWriter>(node, config.link, ethertype);
    }
    if (!ethertypes.receive.empty()) {
        options.receive = true;
        // In lockstep by ethertype only: the ledger counts every frame of it. In real time too, where a relay has to
        // see what is forged beside its streams.
        options.filter.ethertypes = ethertypes.receive;
        if (node.lockstep()) { // what is lost there, somebody waits for
            options.own_sources = lockstep::kRunAddressOctets;
            options.waited_for = false;
        }
        auto receiver = ethernet::Port::open(options);
        if (!receiver) {
            return std::unexpected{receiver.error()};
        }
        port->receiver_ = std::make_unique<ethernet::Port>(std::move(*receiver));
        for (std::uint16_t const ethertype : ethertypes.receive) {
            port->readers_[ethertype] = std::make_unique<bus::WireReader>(
                node, config.receive_link.empty() ? config.link : config.receive_link, ethertype);
            port->readers_[ethertype]->bound(kMaxWaiting);
        }
        if (!node.lockstep()) {
            port->thread_ = std::thread{[raw = port.get()] { raw->receive_loop(); }};
        }
    }
    if (node.lockstep()) { // what is sent to it is in the ring when its ledger comes: nobody has to wake up for it
        node.exchange_frames_with([raw = port.get()] { raw->drain(); }, [raw = port.get()] { raw->flush(); });
    }
    return port;
}

WirePort::~WirePort() {
    stop_ = true;
    if (thread_.joinable()) {
        thread_.join();
    }
}

void WirePort::receive_loop() {
    constexpr std::int64_t kLookAfterNs = 100'000'000;
    auto maintained = std::chrono::steady_clock::now();
    while (!stop_) {
        receiver_->wait(kLookAfterNs);
        drain();
        if (auto const now = std::chrono::steady_clock::now(); now - maintained > std::chrono::milliseconds{200}) {
            maintained = now;
            maintain_receiver();
        }
    }
}

void WirePort::maintain_receiver() {
    std::lock_guard const lock{receiving_};
    receiver_->maintain();
    ethernet::PortCounters const& counters = receiver_->counters();
    dropped_.store(counters.dropped, std::memory_order_relaxed);
    readers_.begin()->second->not_fetched(counters.others_dropped);
}

void WirePort::drain() {
    if (receiver_ == nullptr) {
        return;
    }
    std::lock_guard const lock{receiving_};
    while (true) {
        std::int64_t const looked_ns = ArrivalClock::steady_ns();
        std::size_t const n = receiver_->receive(batch_);
        if (n == 0) {
            arrivals_.nothing_at(looked_ns);
            return;
        }
        ArrivalClock::Reading const now = ArrivalClock::read();
        for (std::size_t i = 0; i < n; ++i) {
            ethernet::ReceivedFrame const& frame = batch_[i];
            std::int64_t const arrived_ns = arrivals_.arrival(frame.stamp_ns, now);
            if (ethernet::is_ip(frame.octets) && !ethernet::is_boxed_ip(frame.octets)) {
                continue; // the kernels' own
            }
            if (auto const reader = readers_.find(iec61850::ethertype_of(frame.octets)); reader != readers_.end()) {
                reader->second->push(std::as_bytes(frame.octets), frame.stamp_ns, 0, arrived_ns);
            }
        }
    }
}

std::optional<SimTime> WirePort::next() const {
    std::optional<SimTime> out;
    for (auto const& [ethertype, reader] : readers_) {
        if (auto const time = reader->next()) {
            out = out ? std::min(*out, *time) : *time;
        }
    }
    return out;
}

std::uint64_t WirePort::dropped() const {
    std::uint64_t out = dropped_.load(std::memory_order_relaxed);
    for (auto const& [ethertype, reader] : readers_) {
        out += reader->dropped();
    }
    return out;
}

std::span<bus::WireFrame const* const> WirePort::take(std::uint16_t ethertype) {
    auto const due = readers_.at(ethertype)->take();
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

void WirePort::send(std::span<std::uint8_t const> frame, SimTime at) {
    std::unique_lock signing{signing_, std::defer_lock};
    if (authentication_ != nullptr) {
        signing.lock(); // samples that are paced have a thread of their own
        WireClock const clock{node_};
        frame = authentication_->sign(frame, clock.utc_at(clock.simulated() ? clock.of(at) : clock.now()));
    }
    if (auto const writer = writers_.find(iec61850::ethertype_of(frame)); writer != writers_.end()) {
        writer->second->sent(std::as_bytes(frame), at);
    }
    if (!node_.lockstep()) {
        (void)sender_.send(frame);
        return;
    }
    outgoing_ends_.push_back(outgoing_.size() + frame.size());
    outgoing_.insert(outgoing_.end(), frame.begin(), frame.end());
    constexpr std::size_t kMostOctets = 256U << 10U;
    if (outgoing_.size() > kMostOctets) {
        flush();
    }
}

void WirePort::flush() {
    if (outgoing_ends_.empty()) {
        return;
    }
    frames_.clear();
    std::size_t begin = 0;
    for (std::size_t const end : outgoing_ends_) {
        frames_.push_back(iec61850::Octets{outgoing_}.subspan(begin, end - begin));
        begin = end;
    }
    if (sender_.send(frames_) < frames_.size()) {
        node_.fail_with({ExitCode::environment,
                         fmt::format("the kernel did not take a frame on '{}'", sender_.interface()),
                         "is the link up?"});
    }
    outgoing_.clear();
    outgoing_ends_.clear();
}

void WirePort::maintain() {
    if (auto const now = std::chrono::steady_clock::now(); now - maintained_ > std::chrono::milliseconds{200}) {
        maintained_ = now;
        sender_.maintain();
        if (receiver_ != nullptr && node_.lockstep()) {
            drain(); // what others send is counted, and makes room
            maintain_receiver();
        }
    }
}

} // namespace gridspace::gateways

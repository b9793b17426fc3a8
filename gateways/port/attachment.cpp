// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/port/attachment.hpp"

#include "gateways/ethernet/boxed_ip.hpp"
#include "gateways/ethernet/interface.hpp"

#include <chrono>

namespace gridspace::gateways {
namespace {

constexpr std::size_t kMaxWaiting = 32U << 20U; ///< octets of one ethertype: four seconds of ten streams

} // namespace

Result<std::unique_ptr<Attachment>> Attachment::open(bus::Node& node, WirePlace const& place,
                                                     std::vector<std::uint16_t> const& send,
                                                     std::vector<std::uint16_t> const& receive) {
    constexpr std::chrono::seconds kPatience{30}; // as for the addresses of the networks
    ethernet::wait_for_interface(place.interface, kPatience);
    ethernet::PortOptions options;
    options.interface = place.interface;
    options.receive = false;
    auto sender = ethernet::Port::open(options);
    if (!sender) {
        return std::unexpected{sender.error()};
    }
    auto out = std::unique_ptr<Attachment>{new Attachment{node, std::move(*sender)}};
    for (std::uint16_t const ethertype : send) {
        out->writers_[ethertype] = std::make_unique<bus::WireWriter>(node, place.link, ethertype);
    }
    if (receive.empty()) {
        return out;
    }
    options.receive = true;
    // In lockstep by ethertype only: the ledger counts every frame of it. In real time too, where a relay has to
    // see what is forged in its streams.
    options.filter.ethertypes = receive;
    options.filter.routable = true;
    if (node.lockstep()) { // what is lost there, somebody waits for
        options.own_sources = lockstep::kRunAddressOctets;
        options.waited_for = false;
    }
    auto receiver = ethernet::Port::open(options);
    if (!receiver) {
        return std::unexpected{receiver.error()};
    }
    out->receiver_ = std::make_unique<ethernet::Port>(std::move(*receiver));
    for (std::uint16_t const ethertype : receive) {
        out->readers_[ethertype] = std::make_unique<bus::WireReader>(
            node, place.receive_link.empty() ? place.link : place.receive_link, ethertype);
        out->readers_[ethertype]->bound(kMaxWaiting);
    }
    if (!node.lockstep()) {
        out->thread_ = std::thread{[raw = out.get()] { raw->receive_loop(); }};
    }
    return out;
}

Attachment::~Attachment() {
    stop_ = true;
    if (thread_.joinable()) {
        thread_.join();
    }
}

void Attachment::receive_loop() {
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

void Attachment::maintain_receiver() {
    std::lock_guard const lock{receiving_};
    receiver_->maintain();
    ethernet::PortCounters const& counters = receiver_->counters();
    dropped_.store(counters.dropped, std::memory_order_relaxed);
    readers_.begin()->second->not_fetched(counters.others_dropped);
}

void Attachment::drain() {
    if (receiver_ == nullptr) {
        return;
    }
    std::lock_guard const lock{receiving_};
    for (std::size_t times = 0; times < ethernet::kMostBatches; ++times) {
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
            if (auto const reader = readers_.find(ethernet::channel_of(frame.octets)); reader != readers_.end()) {
                reader->second->push(std::as_bytes(frame.octets), frame.stamp_ns, 0, arrived_ns);
            }
        }
    }
}

std::optional<SimTime> Attachment::next() const {
    std::optional<SimTime> out;
    for (auto const& [ethertype, reader] : readers_) {
        if (auto const time = reader->next()) {
            out = out ? std::min(*out, *time) : *time;
        }
    }
    return out;
}

std::uint64_t Attachment::dropped() const {
    std::uint64_t out = dropped_.load(std::memory_order_relaxed);
    for (auto const& [ethertype, reader] : readers_) {
        out += reader->dropped();
    }
    return out;
}

void Attachment::send(std::span<std::uint8_t const> frame, SimTime at) {
    if (auto const writer = writers_.find(ethernet::channel_of(frame)); writer != writers_.end()) {
        writer->second->sent(std::as_bytes(frame), at);
    }
    if (!node_.lockstep()) {
        (void)sender_.send(frame);
        return;
    }
    outgoing_ends_.push_back(outgoing_.size() + frame.size());
    outgoing_.insert(outgoing_.end(), frame.begin(), frame.end());
}

bool Attachment::flush() {
    if (outgoing_ends_.empty()) {
        return true;
    }
    frames_.clear();
    std::size_t begin = 0;
    for (std::size_t const end : outgoing_ends_) {
        frames_.push_back(iec61850::Octets{outgoing_}.subspan(begin, end - begin));
        begin = end;
    }
    bool const all = sender_.send(frames_) == frames_.size();
    outgoing_.clear();
    outgoing_ends_.clear();
    return all;
}

void Attachment::maintain() {
    sender_.maintain();
    if (receiver_ != nullptr && node_.lockstep()) {
        drain(); // what others send is counted, and makes room
        maintain_receiver();
    }
}

} // namespace gridspace::gateways

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/wire.hpp"
#include "gateways/ethernet/port.hpp"
#include "gateways/port/arrival_clock.hpp"
#include "gateways/port/wire_config.hpp"

#include <array>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

namespace gridspace::gateways {

/// A process's socket on one link and the simulation clock behind it. In lockstep a frame carries its simulated send
/// time in the ledger of the link and is seen in the tick that contains it; in real time it is seen when it arrives.
class Attachment {
  public:
    /// Opens the interface, waiting for it. Before Node::start; must not outlive the node.
    [[nodiscard]] static Result<std::unique_ptr<Attachment>> open(bus::Node& node, WirePlace const& place,
                                                                  std::vector<std::uint16_t> const& send,
                                                                  std::vector<std::uint16_t> const& receive);
    ~Attachment();
    Attachment(Attachment const&) = delete;
    Attachment& operator=(Attachment const&) = delete;

    [[nodiscard]] iec61850::Mac const& mac() const { return sender_.mac(); }
    /// Real time: to the kernel. Lockstep: kept until flush(). Either way it is in the ledger then.
    void send(std::span<std::uint8_t const> frame, SimTime at);
    /// Lockstep: hands what was sent to the kernel; false: it did not take all.
    bool flush();
    /// Frames that are due, valid until the next call for the same ethertype.
    [[nodiscard]] std::span<bus::WireFrame const* const> take(std::uint16_t ethertype) {
        return readers_.at(ethertype)->take();
    }
    /// Lockstep: the earliest time of the frames that are here and not due yet.
    [[nodiscard]] std::optional<SimTime> next() const;
    /// Fetches what has come.
    void drain();
    /// Looks after the link; a few times a second.
    void maintain();
    [[nodiscard]] ethernet::PortCounters sent_counters() { return sender_.counters(); }
    /// Received frames that the kernel had to drop, as of the last look, or that found no room here.
    [[nodiscard]] std::uint64_t dropped() const;
    [[nodiscard]] std::string const& interface() const { return sender_.interface(); }

  private:
    Attachment(bus::Node& node, ethernet::Port sender) : node_{node}, sender_{std::move(sender)} {}
    void receive_loop();
    void maintain_receiver();

    bus::Node& node_;
    ethernet::Port sender_;
    std::unique_ptr<ethernet::Port> receiver_; ///< but for waiting, under receiving_
    std::mutex receiving_;
    ArrivalClock arrivals_{ArrivalClock::steady_ns()};
    std::array<ethernet::ReceivedFrame, 64> batch_;
    std::map<std::uint16_t, std::unique_ptr<bus::WireWriter>> writers_;
    std::map<std::uint16_t, std::unique_ptr<bus::WireReader>> readers_;
    std::vector<std::uint8_t> outgoing_; ///< lockstep: the frames of the tick so far, one behind the other
    std::vector<std::size_t> outgoing_ends_;
    std::vector<iec61850::Octets> frames_;
    std::atomic<bool> stop_{false};
    std::atomic<std::uint64_t> dropped_{0};
    std::thread thread_;
};

} // namespace gridspace::gateways

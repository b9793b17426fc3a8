// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/wire.hpp"
#include "gateways/ethernet/port.hpp"
#include "gateways/port/arrival_clock.hpp"
#include "gateways/port/frame_authentication.hpp"
#include "gateways/port/wire_config.hpp"

#include <array>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

namespace gridspace::gateways {

/// A process's place on a link: the socket, and the simulation clock behind it. In lockstep a frame carries its
/// simulated send time in the ledger and is seen in the tick that contains it; in real time it is seen when it arrives.
class WirePort {
  public:
    struct Ethertypes {
        std::vector<std::uint16_t> send, receive;
        bool authenticate{true}; ///< false: whoever it is, the keys are not its own
    };
    /// Opens the interface. Before Node::start; must not outlive the node.
    [[nodiscard]] static Result<std::unique_ptr<WirePort>> open(bus::Node& node, WireConfig const& config,
                                                                Ethertypes const& ethertypes);
    ~WirePort();
    WirePort(WirePort const&) = delete;
    WirePort& operator=(WirePort const&) = delete;

    [[nodiscard]] iec61850::Mac const& mac() const { return sender_.mac(); }

    /// Hands a frame to the kernel, with its code when its stream is authenticated. `at`: its simulated send time, in
    /// lockstep, where what belongs to a tick goes together, before the acknowledgement.
    void send(std::span<std::uint8_t const> frame, SimTime at);

    /// Frames that are due and not refused for want of authenticity, valid until the next call for the same ethertype.
    [[nodiscard]] std::span<bus::WireFrame const* const> take(std::uint16_t ethertype);
    /// Nothing when none of its streams is authenticated.
    [[nodiscard]] FrameAuthentication* authentication() { return authentication_.get(); }

    /// Lockstep: the earliest time of the frames that are here and not due yet.
    [[nodiscard]] std::optional<SimTime> next() const;

    /// Real time: fetches what has come and the receiving thread has not fetched yet. Before something counts as run
    /// out: after a stall of this process what came in time waits in the kernel, and who runs first is chance.
    void drain();

    /// Looks after the link; cheap, call it in every round.
    void maintain();
    [[nodiscard]] ethernet::PortCounters sent_counters() { return sender_.counters(); }
    /// Received frames that the kernel had to drop, as of the last look, or that found no room here.
    [[nodiscard]] std::uint64_t dropped() const;

    /// What `gateways/iec61850` decodes.
    [[nodiscard]] static iec61850::Octets octets(bus::WireFrame const& frame) {
        return {reinterpret_cast<std::uint8_t const*>(frame.octets.data()), frame.octets.size()};
    }

  private:
    WirePort(bus::Node& node, ethernet::Port sender) : node_{node}, sender_{std::move(sender)} {}
    void receive_loop();
    void maintain_receiver();
    void flush(); ///< lockstep

    bus::Node& node_;
    ethernet::Port sender_;
    std::unique_ptr<ethernet::Port> receiver_; ///< but for waiting, under receiving_
    std::mutex receiving_;
    ArrivalClock arrivals_{ArrivalClock::steady_ns()};
    std::array<ethernet::ReceivedFrame, 64> batch_;
    std::unique_ptr<FrameAuthentication> authentication_;
    std::mutex signing_;
    std::vector<bus::WireFrame const*> genuine_;
    std::map<std::uint16_t, std::unique_ptr<bus::WireWriter>> writers_;
    std::map<std::uint16_t, std::unique_ptr<bus::WireReader>> readers_;
    std::vector<std::uint8_t> outgoing_; ///< lockstep: the frames of the tick so far, one behind the other
    std::vector<std::size_t> outgoing_ends_;
    std::vector<iec61850::Octets> frames_;
    std::atomic<bool> stop_{false};
    std::atomic<std::uint64_t> dropped_{0};
    std::chrono::steady_clock::time_point maintained_;
    std::thread thread_;
};

} // namespace gridspace::gateways

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/ethernet/group_membership.hpp"
#include "gateways/port/attachment.hpp"
#include "gateways/port/frame_authentication.hpp"
#include "gateways/port/routed_streams.hpp"
#include "gateways/prp/duplicate_discard.hpp"

namespace gridspace::gateways {

/// A process's place on the wire: on one link, or on two as a doubly attached node of PRP (IEC 62439-3), which sends
/// each frame on both and gets the copy that comes first.
class WirePort {
  public:
    struct Ethertypes {
        std::vector<std::uint16_t> send, receive;
        bool authenticate{true};   ///< false: whoever it is, the keys are not its own
        bool open_datagrams{true}; ///< false: R-GOOSE and R-SV come as the datagrams that they are
    };
    /// Opens the interfaces. Before Node::start; must not outlive the node.
    [[nodiscard]] static Result<std::unique_ptr<WirePort>> open(bus::Node& node, WireConfig const& config,
                                                                Ethertypes const& ethertypes);
    ~WirePort();
    WirePort(WirePort const&) = delete;
    WirePort& operator=(WirePort const&) = delete;

    /// Its address; a doubly attached node has the same one on both networks.
    [[nodiscard]] iec61850::Mac const& mac() const { return links_.front()->mac(); }

    /// Hands a frame to the kernel, with its code when its stream is authenticated, in a datagram when it goes over
    /// UDP. `at`: its simulated send time, in lockstep, where what belongs to a tick goes together, before the
    /// acknowledgement.
    void send(std::span<std::uint8_t const> frame, SimTime at);

    /// Frames that are due and not refused for want of authenticity, valid until the next call for the same ethertype.
    /// Messages that came over UDP are there as Ethernet frames of their own.
    [[nodiscard]] std::span<bus::WireFrame const* const> take(std::uint16_t ethertype);
    /// Nothing when none of its streams is authenticated. Who sends beside it (FrameSender) signs with it too.
    [[nodiscard]] FrameAuthentication* authentication() { return authentication_.get(); }

    /// Lockstep: the earliest time of the frames that are here and not due yet.
    [[nodiscard]] std::optional<SimTime> next() const;

    /// Real time: fetches what has come and the receiving thread has not fetched yet. Before something counts as run
    /// out: after a stall of this process what came in time waits in the kernel, and who runs first is chance.
    void drain();

    /// Looks after the links; cheap, call it in every round.
    void maintain();
    /// Of the first link; `sent` counts a frame once.
    [[nodiscard]] ethernet::PortCounters sent_counters() { return links_.front()->sent_counters(); }
    /// Received frames that the kernel had to drop, as of the last look, or that found no room here.
    [[nodiscard]] std::uint64_t dropped() const;

    /// Of its redundancy control trailers: who sends beside it (FrameSender) takes numbers from it too.
    [[nodiscard]] std::atomic<std::uint16_t>& sequence() { return sequence_; }

    /// What `gateways/iec61850` decodes.
    [[nodiscard]] static iec61850::Octets octets(bus::WireFrame const& frame) {
        return {reinterpret_cast<std::uint8_t const*>(frame.octets.data()), frame.octets.size()};
    }

  private:
    explicit WirePort(bus::Node& node) : node_{node} {}
    void send_redundantly(std::span<std::uint8_t const> frame, SimTime at);
    /// What came on either network, first copies only, in the order of their times.
    std::span<bus::WireFrame const* const> take_redundant(std::uint16_t ethertype);
    std::span<bus::WireFrame const* const> opened(std::span<bus::WireFrame const* const> due, std::uint16_t ethertype);
    void flush(); ///< lockstep

    bus::Node& node_;
    RoutedStreams routed_;
    std::vector<std::uint8_t> signed_, datagram_;
    ethernet::GroupMembership groups_;
    bool open_datagrams_{true};
    iec61850::RoutableFrame session_;
    std::map<std::uint16_t, std::vector<std::unique_ptr<bus::WireFrame>>> messages_; ///< out of datagrams, by ethertype
    std::vector<std::uint8_t> message_;
    std::vector<bus::WireFrame const*> opened_;
    std::unique_ptr<FrameAuthentication> authentication_;
    std::mutex sending_;
    std::vector<bus::WireFrame const*> genuine_;
    // of a doubly attached node
    prp::DuplicateDiscard discard_;
    std::atomic<std::uint16_t> sequence_{0};
    std::vector<std::uint8_t> with_trailer_;
    struct Arrival {
        bus::WireFrame const* frame{nullptr};
        prp::Lan lan{prp::Lan::a};
    };
    std::vector<Arrival> arrivals_;
    std::vector<bus::WireFrame const*> firsts_;
    std::size_t outgoing_{0}; ///< lockstep: octets that wait for flush()
    std::chrono::steady_clock::time_point maintained_;
    std::vector<std::unique_ptr<Attachment>> links_; ///< one, or networks A and B
};

} // namespace gridspace::gateways

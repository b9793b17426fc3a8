// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/unique_fd.hpp"
#include "timebox/packet_filter.hpp"

#include <cstdint>
#include <deque>
#include <linux/if_packet.h>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace gridspace::timebox {

/// A frame as a packet socket sees it: the kernel removes the outer VLAN tag and passes it separately.
struct PacketFrame {
    std::int64_t at_ns{0};
    std::vector<std::uint8_t> octets; ///< from the destination address on
    std::uint16_t protocol{0};        ///< ethertype, in the host's order
    std::optional<std::uint16_t> vlan_tci;
    std::uint16_t vlan_protocol{0};
    std::uint8_t type{PACKET_HOST};
    std::size_t kept{0}; ///< octets that the socket's filter lets through, of its view
};
/// `octets`: with their tag. `own`: the interface's address.
[[nodiscard]] PacketFrame packet_frame(std::int64_t at_ns, std::vector<std::uint8_t> octets,
                                       std::array<std::uint8_t, 6> const& own, bool outgoing);

/// The ring of a packet socket (packet(7), TPACKET_V2): memory of the program that we fill as the kernel would.
struct PacketRing {
    tpacket_req shape{};
    unsigned reserve{0};
    pid_t process{0};
    std::uint64_t address{0}; ///< 0: it is not mapped yet
    unsigned next{0};         ///< the slot of the next frame
    UniqueFd file;            ///< of the socket

    [[nodiscard]] bool is_sound() const; ///< as the kernel would take it
    [[nodiscard]] std::uint64_t octets() const { return std::uint64_t{shape.tp_block_size} * shape.tp_block_nr; }
    /// False: the program has not given the slot back.
    bool put(PacketFrame const& frame, std::size_t header, int interface, std::int64_t epoch_ns, bool lossy);
    [[nodiscard]] bool has_unread() const;

  private:
    [[nodiscard]] std::uint64_t slot(unsigned number) const;
};

/// One packet socket of a program. What the kernel has in its place is a socket on which nobody sends: it is readable
/// while a mark of ours lies in it, so that poll, select and epoll see what they should.
struct PacketSocket {
    std::uint64_t inode{0};
    std::string address; ///< of the socket that the kernel has (unix(7)), for marks
    int kind{0};         ///< SOCK_RAW or SOCK_DGRAM
    std::uint16_t protocol{0};
    int interface{0}; ///< 0: any
    bool auxiliary{false}, ignores_outgoing{false};
    int stamps{0}; ///< SO_TIMESTAMP or SO_TIMESTAMPNS
    std::optional<PacketFilter> filter;
    std::size_t room{212'992}, used{0}; ///< octets; SO_RCVBUF
    std::deque<PacketFrame> queue;
    int marks{0};
    tpacket_stats counted{}; ///< since the program has last asked
    int version{TPACKET_V1};
    unsigned reserve{0};
    std::optional<PacketRing> ring;

    [[nodiscard]] bool wants(PacketFrame const& frame, int on_interface) const;
    /// Octets that stand before what it sees of a frame.
    [[nodiscard]] std::size_t header() const;
    /// False: there was no room.
    bool push(PacketFrame const& frame);
    [[nodiscard]] PacketFrame pop();
};

} // namespace gridspace::timebox

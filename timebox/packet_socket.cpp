// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/packet_socket.hpp"

#include <algorithm>
#include <linux/if_ether.h>
#include <sys/socket.h>

namespace gridspace::timebox {
namespace {

constexpr std::size_t kTagOctets = 4, kAddressOctets = 12;
constexpr std::size_t kFrameBookkeeping =
    768; ///< what the kernel charges a buffer for a frame besides its octets, about

std::uint16_t word(std::span<std::uint8_t const> octets, std::size_t at) {
    return static_cast<std::uint16_t>(octets[at] << 8U | octets[at + 1]);
}

} // namespace

PacketFrame packet_frame(std::int64_t at_ns, std::vector<std::uint8_t> octets, std::array<std::uint8_t, 6> const& own,
                         bool outgoing) {
    PacketFrame out;
    out.at_ns = at_ns;
    std::uint16_t const outer = word(octets, kAddressOctets);
    if ((outer == ETH_P_8021Q || outer == ETH_P_8021AD) && octets.size() >= ETH_HLEN + kTagOctets) {
        out.vlan_protocol = outer;
        out.vlan_tci = word(octets, kAddressOctets + 2);
        octets.erase(octets.begin() + kAddressOctets, octets.begin() + kAddressOctets + kTagOctets);
    }
    out.protocol = word(octets, kAddressOctets);
    bool const all = std::all_of(octets.begin(), octets.begin() + ETH_ALEN, [](auto octet) { return octet == 0xFF; });
    out.type = outgoing                                             ? PACKET_OUTGOING
               : all                                                ? PACKET_BROADCAST
               : (octets[0] & 1U) != 0                              ? PACKET_MULTICAST
               : std::equal(own.begin(), own.end(), octets.begin()) ? PACKET_HOST
                                                                    : PACKET_OTHERHOST;
    out.octets = std::move(octets);
    return out;
}

std::size_t PacketSocket::header() const {
    return kind == SOCK_RAW ? 0 : ETH_HLEN;
}

bool PacketSocket::wants(PacketFrame const& frame, int on_interface) const {
    bool const outgoing = frame.type == PACKET_OUTGOING;
    return protocol != 0 && (interface == 0 || interface == on_interface) &&
           (protocol == ETH_P_ALL ? !outgoing || !ignores_outgoing : protocol == frame.protocol && !outgoing);
}

bool PacketSocket::push(PacketFrame const& frame) {
    std::size_t const takes = frame.octets.size() + kFrameBookkeeping;
    if (used + takes > room) {
        return false;
    }
    used += takes;
    queue.push_back(frame);
    return true;
}

PacketFrame PacketSocket::pop() {
    PacketFrame out = std::move(queue.front());
    queue.pop_front();
    used -= out.octets.size() + kFrameBookkeeping;
    return out;
}

} // namespace gridspace::timebox

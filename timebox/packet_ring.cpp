// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/packet_socket.hpp"
#include "timebox/tracee.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cstring>
#include <linux/if_ether.h>
#include <net/if_arp.h>

namespace gridspace::timebox {
namespace {

constexpr std::size_t kRingPage = 4096, kLeastHeader = 16;

std::size_t aligned(std::size_t octets) {
    return (octets + TPACKET_ALIGNMENT - 1) / TPACKET_ALIGNMENT * TPACKET_ALIGNMENT;
}

} // namespace

bool PacketRing::is_sound() const {
    tpacket_req const& r = shape;
    return r.tp_block_size > 0 && r.tp_block_size % kRingPage == 0 && r.tp_frame_size % TPACKET_ALIGNMENT == 0 &&
           r.tp_frame_size >= TPACKET2_HDRLEN + reserve && r.tp_frame_size <= r.tp_block_size &&
           r.tp_block_size / r.tp_frame_size * r.tp_block_nr == r.tp_frame_nr;
}

std::uint64_t PacketRing::slot(unsigned number) const {
    unsigned const per_block = shape.tp_block_size / shape.tp_frame_size;
    return address + std::uint64_t{number / per_block} * shape.tp_block_size +
           std::uint64_t{number % per_block} * shape.tp_frame_size;
}

bool PacketRing::has_unread() const {
    unsigned const last = (next + shape.tp_frame_nr - 1) % shape.tp_frame_nr;
    return address != 0 && (value_at<std::uint32_t>(process, slot(last)) & TP_STATUS_USER) != 0;
}

bool PacketRing::put(PacketFrame const& frame, std::size_t header, int interface, std::int64_t epoch_ns, bool lossy) {
    if (address == 0 || value_at<std::uint32_t>(process, slot(next)) != TP_STATUS_KERNEL) {
        return false;
    }
    // af_packet.c, tpacket_rcv(): the network header is aligned, the link header stands before it.
    std::size_t const link = ETH_HLEN - header;
    std::size_t const network =
        aligned(TPACKET2_HDRLEN + (header > 0 ? kLeastHeader : std::max(link, kLeastHeader))) + reserve;
    std::size_t const at = network - link;
    std::size_t const fits = shape.tp_frame_size > at ? shape.tp_frame_size - at : 0;
    std::size_t const kept = std::min(frame.kept, fits);

    std::vector<std::uint8_t> image(at + kept);
    tpacket2_hdr head{};
    head.tp_status = TP_STATUS_USER | (lossy ? TP_STATUS_LOSING : 0U) |
                     (frame.vlan_tci ? TP_STATUS_VLAN_VALID | TP_STATUS_VLAN_TPID_VALID : 0U);
    head.tp_len = static_cast<std::uint32_t>(frame.octets.size() - header);
    head.tp_snaplen = static_cast<std::uint32_t>(kept);
    head.tp_mac = static_cast<std::uint16_t>(at);
    head.tp_net = static_cast<std::uint16_t>(network);
    head.tp_sec = static_cast<std::uint32_t>((epoch_ns + frame.at_ns) / 1'000'000'000);
    head.tp_nsec = static_cast<std::uint32_t>((epoch_ns + frame.at_ns) % 1'000'000'000);
    head.tp_vlan_tci = frame.vlan_tci.value_or(0);
    head.tp_vlan_tpid = frame.vlan_protocol;
    sockaddr_ll from{};
    from.sll_family = AF_PACKET;
    from.sll_protocol = htons(frame.protocol);
    from.sll_ifindex = interface;
    from.sll_hatype = ARPHRD_ETHER;
    from.sll_pkttype = frame.type;
    from.sll_halen = ETH_ALEN;
    std::copy_n(frame.octets.begin() + ETH_ALEN, ETH_ALEN, from.sll_addr);
    std::memcpy(image.data(), &head, sizeof head);
    std::memcpy(image.data() + aligned(sizeof head), &from, sizeof from);
    std::copy_n(frame.octets.begin() + static_cast<std::ptrdiff_t>(header), kept,
                image.begin() + static_cast<std::ptrdiff_t>(at));
    if (!write_memory(process, slot(next), image.data(), image.size())) {
        return false;
    }
    next = (next + 1) % shape.tp_frame_nr;
    return true;
}

} // namespace gridspace::timebox

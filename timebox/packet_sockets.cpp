// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/packet_sockets.hpp"

#include "timebox/ip/stand_in.hpp"

#include <algorithm>
#include <cerrno>
#include <linux/if_ether.h>
#include <sys/socket.h>

namespace gridspace::timebox {
namespace {

void take_mark(PacketSocket& socket, int file) {
    char octet = 0;
    if (::recv(file, &octet, 1, MSG_DONTWAIT) == 1) {
        --socket.marks;
    } else {
        socket.marks = 0;
    }
}

} // namespace

PacketSockets::PacketSockets(PacketLink link, std::int64_t epoch_ns)
    : link_{std::move(link)}, epoch_ns_{epoch_ns}, marker_{::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)} {}

bool PacketSockets::add(UniqueFd const& file, int kind, std::uint16_t protocol) {
    std::string address = give_address(file);
    if (address.empty()) {
        return false;
    }
    PacketSocket& socket = sockets_.emplace_back();
    socket.inode = socket_inode_of(file);
    socket.address = std::move(address);
    socket.kind = kind;
    socket.protocol = protocol;
    return true;
}

PacketSocket* PacketSockets::find(UniqueFd const& file) {
    std::uint64_t const inode = sockets_.empty() ? 0 : socket_inode_of(file);
    auto const it = std::ranges::find(sockets_, inode, &PacketSocket::inode);
    return inode == 0 || it == sockets_.end() ? nullptr : &*it;
}

bool PacketSockets::mark(PacketSocket& socket) const {
    if (socket.marks >= kMostMarks) {
        return true;
    }
    bool const sent = send_to(marker_, socket.address);
    socket.marks += sent ? 1 : 0;
    return sent || errno != ECONNREFUSED;
}

void PacketSockets::taken(PacketSocket& socket, UniqueFd const& file) {
    while (socket.marks > 0 && static_cast<std::size_t>(socket.marks) > socket.queue.size()) {
        take_mark(socket, file.get());
    }
}

void PacketSockets::look_at_rings() {
    for (PacketSocket& socket : sockets_) {
        if (!socket.ring) {
            continue;
        }
        bool const unread = socket.ring->has_unread();
        while (socket.marks > (unread ? 1 : 0)) {
            take_mark(socket, socket.ring->file.get());
        }
    }
}

void PacketSockets::hand(PacketFrame const& frame, PacketSocket const* except) {
    for (auto it = sockets_.begin(); it != sockets_.end();) {
        PacketSocket& socket = *it++;
        if (&socket == except || !socket.wants(frame, link_.index)) {
            continue;
        }
        std::size_t const header = socket.header(), octets = frame.octets.size() - header;
        PacketFrame seen = frame;
        seen.kept = octets;
        if (socket.filter) {
            FilterInput const input{std::span{frame.octets}.subspan(header),
                                    ETH_HLEN - header,
                                    frame.protocol,
                                    frame.type,
                                    link_.index,
                                    frame.vlan_tci,
                                    frame.vlan_protocol};
            seen.kept = std::min<std::size_t>(socket.filter->run(input), octets);
            if (seen.kept == 0) {
                continue;
            }
        }
        ++socket.counted.tp_packets;
        bool const taken = socket.ring
                               ? socket.ring->put(seen, header, link_.index, epoch_ns_, socket.counted.tp_drops > 0)
                               : socket.push(seen);
        if (!taken) {
            ++socket.counted.tp_drops;
        } else if (!mark(socket)) {
            sockets_.erase(std::prev(it));
        }
    }
}

void PacketSockets::deliver(std::int64_t now_ns) {
    while (!coming_.empty() && coming_.front().at_ns <= now_ns) {
        hand(coming_.front(), nullptr);
        coming_.pop_front();
    }
}

void PacketSockets::leaves(std::span<std::uint8_t const> frame, std::int64_t now_ns) {
    if (!sockets_.empty()) {
        hand(packet_frame(now_ns, {frame.begin(), frame.end()}, link_.mac, true), nullptr);
    }
}

std::string PacketSockets::send(PacketSocket const& from, std::vector<std::uint8_t> frame, std::int64_t now_ns) {
    std::string refused = link_.send(frame, now_ns);
    if (refused.empty()) {
        hand(packet_frame(now_ns, std::move(frame), link_.mac, true), &from);
    }
    return refused;
}

} // namespace gridspace::timebox

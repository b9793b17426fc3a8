// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/packet_calls.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <linux/if_ether.h>
#include <net/if_arp.h>
#include <sys/syscall.h>
#include <sys/time.h>

namespace gridspace::timebox {
namespace {

constexpr std::size_t kLongestFrame = ETH_FRAME_LEN + 4; ///< with a VLAN tag

sockaddr_ll address_of(PacketLink const& link, std::uint16_t protocol) {
    sockaddr_ll out{};
    out.sll_family = AF_PACKET;
    out.sll_protocol = htons(protocol);
    out.sll_ifindex = link.index;
    out.sll_hatype = ARPHRD_ETHER;
    out.sll_halen = ETH_ALEN;
    return out;
}

template <class T>
void append_control(std::vector<std::uint8_t>& out, int level, int type, T const& value) {
    cmsghdr const head{CMSG_LEN(sizeof value), level, type};
    std::size_t const at = out.size();
    out.resize(at + CMSG_SPACE(sizeof value));
    std::memcpy(out.data() + at, &head, sizeof head);
    std::memcpy(out.data() + at + CMSG_LEN(0), &value, sizeof value);
}

} // namespace

std::int64_t PacketCalls::bind(Thread const& t, PacketSocket& socket) const {
    auto const address = value_at<sockaddr_ll>(t.tid, t.call.arguments[1]);
    if (t.call.arguments[2] < offsetof(sockaddr_ll, sll_addr) || address.sll_family != AF_PACKET) {
        return -EINVAL;
    }
    if (address.sll_ifindex != 0 && address.sll_ifindex != sockets_.link().index) {
        refused_("a packet socket on another interface than '" + sockets_.link().name + "'");
        return -ENODEV;
    }
    socket.interface = address.sll_ifindex;
    socket.protocol = address.sll_protocol != 0 ? ntohs(address.sll_protocol) : socket.protocol;
    return 0;
}

std::int64_t PacketCalls::name(Thread const& t, PacketSocket const& socket) const {
    sockaddr_ll own = address_of(sockets_.link(), socket.protocol);
    own.sll_ifindex = socket.interface;
    if (socket.interface == 0) {
        own.sll_hatype = 0;
        own.sll_halen = 0;
    } else {
        std::copy(sockets_.link().mac.begin(), sockets_.link().mac.end(), own.sll_addr);
    }
    auto const size = static_cast<socklen_t>(offsetof(sockaddr_ll, sll_addr) + own.sll_halen);
    auto const room = value_at<socklen_t>(t.tid, t.call.arguments[2]);
    (void)write_memory(t.tid, t.call.arguments[1], &own, std::min(room, size));
    put(t.tid, t.call.arguments[2], size);
    return 0;
}

std::int64_t PacketCalls::send_one(Thread const& t, PacketSocket const& socket, Message const& message) {
    std::vector<std::uint8_t> octets;
    sockaddr_ll to = address_of(sockets_.link(), socket.protocol);
    to.sll_ifindex = socket.interface;
    if (message.name != 0) {
        if (message.name_size < offsetof(sockaddr_ll, sll_addr) ||
            !read_memory(t.tid, message.name, &to, std::min<std::size_t>(message.name_size, sizeof to)) ||
            to.sll_family != AF_PACKET) {
            return -EINVAL;
        }
    }
    if (to.sll_ifindex != sockets_.link().index) {
        return -ENXIO;
    }
    if (socket.kind == SOCK_DGRAM) {
        auto const protocol = static_cast<std::uint16_t>(message.name != 0 ? ntohs(to.sll_protocol) : socket.protocol);
        octets.assign(to.sll_addr, to.sll_addr + ETH_ALEN);
        octets.insert(octets.end(), sockets_.link().mac.begin(), sockets_.link().mac.end());
        octets.push_back(static_cast<std::uint8_t>(protocol >> 8U));
        octets.push_back(static_cast<std::uint8_t>(protocol));
    }
    std::size_t const before = octets.size();
    if (!gather(t.tid, message, octets)) {
        return -EFAULT;
    }
    if (octets.size() < ETH_HLEN) {
        return -EINVAL;
    }
    bool const tagged = octets[12] == 0x81 && octets[13] == 0;
    if (octets.size() > kLongestFrame || (!tagged && octets.size() > ETH_FRAME_LEN)) {
        return -EMSGSIZE;
    }
    auto const sent = static_cast<std::int64_t>(octets.size() - before);
    std::string const why = sockets_.send(socket, std::move(octets), clock_.now_ns());
    return why.empty() ? sent : refuse(why, EPERM);
}

std::int64_t PacketCalls::send(Thread const& t, PacketSocket const& socket) {
    return each_message(t.tid, t.call,
                        [&](Message const& message) { return std::optional{send_one(t, socket, message)}; });
}

std::vector<std::uint8_t> PacketCalls::control(PacketSocket const& socket, PacketFrame const& frame) const {
    std::vector<std::uint8_t> out;
    timespec const stamp = to_timespec(sockets_.epoch_ns() + frame.at_ns);
    if (socket.stamps == SO_TIMESTAMP) {
        append_control(out, SOL_SOCKET, SCM_TIMESTAMP, timeval{stamp.tv_sec, stamp.tv_nsec / 1000});
    } else if (socket.stamps == SO_TIMESTAMPNS) {
        append_control(out, SOL_SOCKET, SCM_TIMESTAMPNS, stamp);
    }
    if (socket.auxiliary) {
        tpacket_auxdata data{};
        data.tp_status = TP_STATUS_USER | (frame.vlan_tci ? TP_STATUS_VLAN_VALID | TP_STATUS_VLAN_TPID_VALID : 0U);
        data.tp_len = static_cast<std::uint32_t>(frame.octets.size() - socket.header());
        data.tp_snaplen = static_cast<std::uint32_t>(frame.kept);
        data.tp_net = static_cast<std::uint16_t>(ETH_HLEN - socket.header());
        data.tp_vlan_tci = frame.vlan_tci.value_or(0);
        data.tp_vlan_tpid = frame.vlan_protocol;
        append_control(out, SOL_PACKET, PACKET_AUXDATA, data);
    }
    return out;
}

std::int64_t PacketCalls::receive_one(Thread const& t, PacketSocket const& socket, PacketFrame const& frame,
                                      Message const& message, int flags) const {
    std::size_t const copied = std::min(frame.kept, room_of(message));
    if (!scatter(t.tid, message, std::span{frame.octets}.subspan(socket.header(), copied))) {
        return -EFAULT;
    }
    sockaddr_ll from = address_of(sockets_.link(), frame.protocol);
    from.sll_pkttype = frame.type;
    std::copy_n(frame.octets.begin() + ETH_ALEN, ETH_ALEN, from.sll_addr);
    socklen_t const size = sizeof from;
    if (message.name != 0) {
        (void)write_memory(t.tid, message.name, &from, std::min<std::size_t>(message.name_size, size));
    }
    if (message.name_size_at != 0) {
        put(t.tid, message.name_size_at, size);
    }
    if (message.header != 0) {
        msghdr fields = message.fields;
        std::vector<std::uint8_t> const beside = control(socket, frame);
        bool const fits = beside.size() <= fields.msg_controllen;
        if (fits && !beside.empty()) {
            (void)write_memory(t.tid, reinterpret_cast<std::uint64_t>(fields.msg_control), beside.data(),
                               beside.size());
        }
        fields.msg_controllen = fits ? beside.size() : 0;
        fields.msg_namelen = fields.msg_name != nullptr ? size : 0;
        fields.msg_flags = (copied < frame.kept ? MSG_TRUNC : 0) | (fits ? 0 : MSG_CTRUNC);
        put(t.tid, message.header, fields);
    }
    return static_cast<std::int64_t>((flags & MSG_TRUNC) != 0 ? frame.kept : copied);
}

std::int64_t PacketCalls::receive(Thread const& t, PacketSocket& socket, UniqueFd const& file) const {
    int const flags = flags_of(t.call);
    return each_message(t.tid, t.call, [&](Message const& message) -> std::optional<std::int64_t> {
        if (socket.queue.empty()) {
            return std::nullopt;
        }
        PacketFrame const frame = (flags & MSG_PEEK) != 0 ? socket.queue.front() : socket.pop();
        std::int64_t const result = receive_one(t, socket, frame, message, flags);
        sockets_.taken(socket, file);
        return result;
    });
}

} // namespace gridspace::timebox

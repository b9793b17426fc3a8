// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// setsockopt(2) and getsockopt(2) of IP sockets.
#include "timebox/ip_address.hpp"
#include "timebox/ip_calls.hpp"

#include <fmt/format.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

namespace gridspace::timebox {
namespace {

constexpr int kMss = 1460;

int whole_number(Thread const& t) {
    auto const& a = t.call.arguments;
    return a[4] >= sizeof(int) ? value_at<int>(t.tid, a[3]) : a[4] >= 1 ? value_at<std::uint8_t>(t.tid, a[3]) : 0;
}

std::int64_t tell(Thread const& t, int value) {
    auto const& a = t.call.arguments;
    auto const size = std::min<socklen_t>(value_at<socklen_t>(t.tid, a[4]), sizeof value);
    (void)write_memory(t.tid, a[3], &value, size);
    put(t.tid, a[4], size);
    return 0;
}

} // namespace

std::optional<std::int64_t> IpCalls::option(Thread const& t, IpSocket& socket) {
    auto const level = static_cast<int>(t.call.arguments[1]), name = static_cast<int>(t.call.arguments[2]);
    int const value = whole_number(t);
    if (level == IPPROTO_TCP && socket.stream) {
        return tcp_option(t, socket, name);
    }
    if (level == IPPROTO_IP) {
        return ip_option(t, socket, name);
    }
    if (level == IPPROTO_IPV6) {
        return -ENOPROTOOPT; // as of every socket of IPv4
    }
    if (level != SOL_SOCKET) {
        return refuse(fmt::format("option {} of level {} of an IP socket", name, level), ENOPROTOOPT);
    }
    switch (name) {
    case SO_REUSEADDR:
    case SO_REUSEPORT:
        socket.reuse = value != 0;
        socket.remembered[{level, name}] = value != 0 ? 1 : 0;
        return 0;
    case SO_BROADCAST:
        socket.broadcast = value != 0;
        break;
    case SO_KEEPALIVE:
        socket.tcp_options.keep_alive = value != 0;
        break;
    case SO_LINGER: {
        auto const linger = value_at<struct linger>(t.tid, t.call.arguments[3]);
        socket.resets_at_close = linger.l_onoff != 0 && linger.l_linger == 0;
        return 0;
    }
    case SO_SNDBUF:
        socket.send_room = value;
        return 0;
    case SO_RCVBUF:
        socket.receive_room = std::max(value, 1152);
        break;
    case SO_ERROR:
    case SO_TYPE:
    case SO_DOMAIN:
    case SO_PROTOCOL:
        return -ENOPROTOOPT;
    case SO_BINDTODEVICE:
    case SO_MARK:
    case SO_INCOMING_CPU:
    case SO_ZEROCOPY:
    case SO_ATTACH_FILTER:
    case SO_ATTACH_BPF:
    case SO_ATTACH_REUSEPORT_CBPF:
    case SO_TIMESTAMP:
    case SO_TIMESTAMPNS:
    case SO_TIMESTAMPING:
        return refuse(fmt::format("socket option {} of an IP socket", name), ENOPROTOOPT);
    default:
        return std::nullopt; // timeouts and the like: what the kernel has in its place keeps them
    }
    sockets_.apply_options(socket);
    return 0;
}

std::optional<std::int64_t> IpCalls::tcp_option(Thread const& t, IpSocket& socket, int name) {
    int const value = whole_number(t);
    auto& options = socket.tcp_options;
    switch (name) {
    case TCP_NODELAY:
        options.no_delay = value != 0;
        break;
    case TCP_KEEPIDLE:
        options.keep_idle_s = static_cast<std::uint32_t>(value);
        break;
    case TCP_KEEPINTVL:
        options.keep_interval_s = static_cast<std::uint32_t>(value);
        break;
    case TCP_KEEPCNT:
        options.keep_count = static_cast<std::uint32_t>(value);
        break;
    default:
        return refuse(fmt::format("option {} of TCP", name), ENOPROTOOPT);
    }
    sockets_.apply_options(socket);
    return 0;
}

std::optional<std::int64_t> IpCalls::ip_option(Thread const& t, IpSocket& socket, int name) {
    auto const& a = t.call.arguments;
    int const value = whole_number(t);
    switch (name) {
    case IP_TOS:
        socket.tcp_options.service = static_cast<std::uint8_t>(value);
        break;
    case IP_TTL:
        if (value == 0 || value > 255) {
            return -EINVAL;
        }
        socket.tcp_options.time_to_live = static_cast<std::uint8_t>(value < 0 ? 255 : value);
        break;
    case IP_MTU_DISCOVER: // the only router is a switch
    case IP_BIND_ADDRESS_NO_PORT:
    case IP_MULTICAST_IF:  // there is one
    case IP_MULTICAST_ALL: // groups are the box's
        socket.remembered[{IPPROTO_IP, name}] = value;
        return 0;
    case IP_PKTINFO:
        socket.packet_info = value != 0;
        return 0;
    case IP_MULTICAST_TTL:
        socket.multicast_ttl = static_cast<std::uint8_t>(value);
        break;
    case IP_MULTICAST_LOOP:
        socket.multicast_loop = value != 0;
        break;
    case IP_ADD_MEMBERSHIP:
    case IP_DROP_MEMBERSHIP: {
        auto const request = value_at<ip_mreq>(t.tid, a[3]); // ip_mreqn begins with the same
        std::uint32_t const group = ntohl(request.imr_multiaddr.s_addr);
        return -(name == IP_ADD_MEMBERSHIP ? sockets_.join(socket, group) : sockets_.leave(socket, group));
    }
    default:
        return refuse(fmt::format("option {} of IP", name), ENOPROTOOPT);
    }
    sockets_.apply_options(socket);
    return 0;
}

std::optional<std::int64_t> IpCalls::look_at_option(Thread const& t, IpSocket& socket) const {
    auto const level = static_cast<int>(t.call.arguments[1]), name = static_cast<int>(t.call.arguments[2]);
    if (auto const it = socket.remembered.find({level, name}); it != socket.remembered.end()) {
        return tell(t, it->second);
    }
    auto const& options = socket.tcp_options;
    if (level == IPPROTO_TCP && socket.stream) {
        switch (name) {
        case TCP_NODELAY:
            return tell(t, options.no_delay ? 1 : 0);
        case TCP_MAXSEG:
            return tell(t, kMss);
        case TCP_KEEPIDLE:
            return tell(t, static_cast<int>(options.keep_idle_s));
        case TCP_KEEPINTVL:
            return tell(t, static_cast<int>(options.keep_interval_s));
        case TCP_KEEPCNT:
            return tell(t, static_cast<int>(options.keep_count));
        default:
            return -ENOPROTOOPT;
        }
    }
    if (level == IPPROTO_IP) {
        return name == IP_MULTICAST_TTL    ? tell(t, socket.multicast_ttl)
               : name == IP_MULTICAST_LOOP ? tell(t, socket.multicast_loop ? 1 : 0)
               : name == IP_TTL            ? tell(t, options.time_to_live)
               : name == IP_TOS            ? tell(t, options.service)
                                           : std::int64_t{-ENOPROTOOPT};
    }
    if (level != SOL_SOCKET) {
        return -ENOPROTOOPT;
    }
    switch (name) {
    case SO_ERROR: {
        int error = 0;
        if (socket.stream) {
            error = std::exchange(socket.error, 0);
        } else {
            error = socket.udp->take_error();
        }
        return tell(t, error);
    }
    case SO_DOMAIN:
        return tell(t, AF_INET);
    case SO_PROTOCOL:
        return tell(t, socket.stream ? IPPROTO_TCP : IPPROTO_UDP);
    case SO_REUSEADDR:
        return tell(t, socket.reuse ? 1 : 0);
    case SO_BROADCAST:
        return tell(t, socket.broadcast ? 1 : 0);
    case SO_KEEPALIVE:
        return tell(t, options.keep_alive ? 1 : 0);
    case SO_SNDBUF:
        return tell(t, socket.send_room);
    case SO_RCVBUF:
        return tell(t, socket.receive_room);
    default:
        return std::nullopt;
    }
}

} // namespace gridspace::timebox

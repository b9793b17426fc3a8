// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Addresses and connections of IP sockets.
#include "timebox/ip_calls.hpp"

#include "timebox/ip_address.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

namespace gridspace::timebox {

std::int64_t IpCalls::bind(Thread const& t, IpSocket& socket) {
    NamedAddress const to = address_at(t.tid, t.call.arguments[1], t.call.arguments[2]);
    if (to.error != 0) {
        return -to.error;
    }
    return -sockets_.bind(socket, to.endpoint);
}

std::int64_t IpCalls::listen(Thread const& t, IpSocket& socket, UniqueFd const& file) {
    return -sockets_.listen(socket, file, static_cast<int>(t.call.arguments[1]));
}

std::optional<std::int64_t> IpCalls::connect(Thread const& t, IpSocket& socket, UniqueFd const& file, bool waits) {
    NamedAddress const to = address_at(t.tid, t.call.arguments[1], t.call.arguments[2]);
    if (to.error != 0) {
        return -to.error;
    }
    int const error =
        sockets_.connect(socket, file, to.family == AF_UNSPEC ? std::nullopt : std::optional{to.endpoint});
    if (waits && (error == EINPROGRESS || error == EALREADY)) {
        return std::nullopt;
    }
    if (error == socket.error) {
        socket.error = 0; // reported
    }
    return -error;
}

std::int64_t IpCalls::connected(IpSocket& socket) {
    return socket.state == IpSocket::State::open         ? 0
           : socket.state == IpSocket::State::connecting ? -EINPROGRESS
                                                         : -std::exchange(socket.error, 0);
}

std::int64_t IpCalls::name(Thread const& t, IpSocket const& socket, bool peer) const {
    IpEndpoint out;
    if (!peer) {
        out = socket.stream ? socket.local : socket.udp->local();
    } else if (socket.stream ? socket.state == IpSocket::State::open : socket.udp->remote().has_value()) {
        out = socket.stream ? socket.remote : *socket.udp->remote();
    } else {
        return -ENOTCONN;
    }
    put_address(t.tid, t.call.arguments[1], t.call.arguments[2], value_at<socklen_t>(t.tid, t.call.arguments[2]), out);
    return 0;
}

/// Interfaces are the kernel's: it answers about them by a socket of ours.
std::optional<std::int64_t> IpCalls::control(Thread const& t, IpSocket& socket) {
    std::uint64_t const request = t.call.arguments[1] & 0xFFFFFFFFU, at = t.call.arguments[2];
    if (request == FIONREAD && !socket.stream) {
        auto const& queue = socket.udp->queue();
        put(t.tid, at, static_cast<int>(queue.empty() ? 0 : queue.front().octets.size()));
        return 0;
    }
    if ((request & 0xFF00U) != 0x8900U) {
        return std::nullopt;
    }
    UniqueFd const own{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
    switch (request) {
    case SIOCGIFCONF: {
        auto list = value_at<ifconf>(t.tid, at);
        std::vector<char> room(
            list.ifc_buf == nullptr
                ? 0
                : std::min<std::size_t>(static_cast<std::size_t>(std::max(list.ifc_len, 0)), 1U << 16U));
        ifconf mine{static_cast<int>(room.size()), {room.empty() ? nullptr : room.data()}};
        if (::ioctl(own.get(), SIOCGIFCONF, &mine) != 0) {
            return -errno;
        }
        if (!room.empty()) {
            (void)write_memory(t.tid, reinterpret_cast<std::uint64_t>(list.ifc_buf), room.data(),
                               static_cast<std::size_t>(mine.ifc_len));
        }
        list.ifc_len = mine.ifc_len;
        put(t.tid, at, list);
        return 0;
    }
    case SIOCGIFADDR:
    case SIOCGIFNETMASK:
    case SIOCGIFBRDADDR:
    case SIOCGIFDSTADDR:
    case SIOCGIFFLAGS:
    case SIOCGIFHWADDR:
    case SIOCGIFMTU:
    case SIOCGIFMETRIC:
    case SIOCGIFINDEX:
    case SIOCGIFNAME: {
        auto about = value_at<ifreq>(t.tid, at);
        if (::ioctl(own.get(), request, &about) != 0) {
            return -errno;
        }
        put(t.tid, at, about);
        return 0;
    }
    default:
        return refuse("ioctl of an IP socket beyond questions about interfaces", EOPNOTSUPP);
    }
}

} // namespace gridspace::timebox

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Where the call table meets packet sockets.
#include "timebox/call_table.hpp"
#include "timebox/ip/stand_in.hpp"

#include <cerrno>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/time.h>

namespace gridspace::timebox {
namespace {} // namespace

CallTable::Named CallTable::packet_socket_of(Thread const& t, std::size_t argument) {
    if (!packets_) {
        return {};
    }
    Named out;
    out.file = descriptors(t.process).copy_of(static_cast<int>(t.call.arguments[argument]));
    out.socket = packets_->find(out.file);
    return out;
}

/// Stamps of the kernel's clock would show real time, and a ring is filled without a call.
CallTable::Next CallTable::option(Thread& t) {
    remember_receive_timeout(t);
    if (Named const named = packet_socket_of(t); named.socket != nullptr) {
        if (auto const result = packet_calls_->option(t, *named.socket, named.file)) {
            answer(t.tid, *result);
        }
        return Next::go;
    }
    if (auto const next = ip_call(t)) {
        return *next;
    }
    auto const level = static_cast<int>(t.call.arguments[1]), name = static_cast<int>(t.call.arguments[2]);
    bool const stamps =
        level == SOL_SOCKET && (name == SO_TIMESTAMP || name == SO_TIMESTAMPNS || name == SO_TIMESTAMPING);
    bool const ring = level == SOL_PACKET && (name == PACKET_RX_RING || name == PACKET_TX_RING);
    return stamps ? refuse(t, "SO_TIMESTAMP (stamps of the kernel's clock)", ENOPROTOOPT)
           : ring ? refuse(t, "PACKET_RX_RING (a ring that the kernel fills)", ENOPROTOOPT)
                  : Next::go;
}

void CallTable::remember_receive_timeout(Thread const& t) {
    auto const& a = t.call.arguments;
    if (static_cast<int>(a[1]) != SOL_SOCKET || static_cast<int>(a[2]) != SO_RCVTIMEO) {
        return;
    }
    auto const value = value_at<timeval>(t.tid, a[3]);
    if (std::uint64_t const inode = socket_inode_of(descriptors(t.process).copy_of(static_cast<int>(a[0])));
        inode != 0) {
        receive_timeouts_[inode] = timebox::to_ns(value);
    }
}

std::optional<std::int64_t> CallTable::exact_receive_timeout_ns(UniqueFd const& file) const {
    auto const told = receive_timeout_ns(file);
    auto const asked = told ? receive_timeouts_.find(socket_inode_of(file)) : receive_timeouts_.end();
    return asked == receive_timeouts_.end() ? told : std::optional{asked->second};
}

CallTable::Next CallTable::packet(Thread& t) {
    if (!packets_) {
        return Next::go;
    }
    if (t.call.number == SYS_socket) {
        return new_socket(t);
    }
    if (t.call.number == SYS_mmap) {
        return map_memory(t);
    }
    Named const named = packet_socket_of(t);
    if (named.socket == nullptr) {
        return ip_call(t).value_or(Next::go);
    }
    if (t.call.number == SYS_bind) {
        answer(t.tid, packet_calls_->bind(t, *named.socket));
    } else if (t.call.number == SYS_getsockname) {
        answer(t.tid, packet_calls_->name(t, *named.socket));
    } else if (t.call.number == SYS_getsockopt) {
        if (auto const result = packet_calls_->look_at_option(t, *named.socket)) {
            answer(t.tid, *result);
        }
    }
    return Next::go;
}

/// The kernel makes another one in its place, which can be waited for as for any.
CallTable::Next CallTable::new_socket(Thread& t) {
    auto const& a = t.call.arguments;
    bool const of_ip = a[0] == AF_INET || a[0] == AF_INET6;
    if (of_ip && ip_) {
        return new_ip_socket(t);
    }
    if (of_ip) {
        ++report_.not_simulated["sockets of IP: what comes to them from other hosts comes in real time (in a run, "
                                "`sends: [ip]` puts them into simulated time)"];
    }
    if (a[0] != AF_PACKET) {
        return Next::go;
    }
    auto const kind = static_cast<int>(a[1] & ~kSocketFlags);
    if (kind != SOCK_RAW && kind != SOCK_DGRAM) {
        return refuse(t, "a packet socket of another kind than SOCK_RAW and SOCK_DGRAM", ESOCKTNOSUPPORT);
    }
    Call other = t.call;
    other.arguments = {AF_UNIX, SOCK_DGRAM | (a[1] & kSocketFlags), 0};
    replace(t.tid, other);
    t.on_exit = Thread::OnExit::new_packet_socket;
    return Next::go_to_exit;
}

/// The ring of a packet socket is memory that nobody else has.
CallTable::Next CallTable::map_memory(Thread& t) {
    if ((t.call.arguments[3] & MAP_ANONYMOUS) != 0) {
        return Next::go;
    }
    Named const named = packet_socket_of(t, 4);
    if (named.socket == nullptr) {
        return Next::go;
    }
    if (!named.socket->ring || t.call.arguments[1] != named.socket->ring->octets()) {
        answer(t.tid, -EINVAL);
        return Next::go;
    }
    Call other = t.call;
    other.arguments[3] |= MAP_ANONYMOUS;
    other.arguments[4] = static_cast<std::uint64_t>(-1);
    other.arguments[5] = 0;
    replace(t.tid, other);
    t.on_exit = Thread::OnExit::ring_mapped;
    return Next::go_to_exit;
}

CallTable::Next CallTable::packet_transfer(Thread& t, PacketSocket& socket, UniqueFd const& file, short event,
                                           bool waits) {
    if (event == POLLOUT) {
        answer(t.tid, packet_calls_->send(t, socket));
        return Next::go;
    }
    if (!socket.queue.empty()) {
        answer(t.tid, packet_calls_->receive(t, socket, file));
        return Next::go;
    }
    if (!waits) {
        look_again();
        answer(t.tid, -EAGAIN);
        return Next::go;
    }
    t.interests = {{static_cast<int>(t.call.arguments[0]), event}};
    auto const patience = exact_receive_timeout_ns(file);
    return hold_until(t, patience ? std::optional{clock_.now_ns() + *patience} : std::nullopt);
}

} // namespace gridspace::timebox

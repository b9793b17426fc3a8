// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Where the call table meets IP sockets.
#include "timebox/call_table.hpp"
#include "timebox/ip_address.hpp"

#include <cerrno>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>

namespace gridspace::timebox {
namespace {

bool is_accept(Thread const& t) {
    return t.call.number == SYS_accept || t.call.number == SYS_accept4;
}

} // namespace

CallTable::NamedIp CallTable::ip_socket_of(Thread const& t) {
    if (!ip_) {
        return {};
    }
    NamedIp out;
    out.file = descriptors(t.process).copy_of(static_cast<int>(t.call.arguments[0]));
    out.socket = ip_->find(out.file);
    return out;
}

CallTable::Next CallTable::new_ip_socket(Thread& t) {
    auto const& a = t.call.arguments;
    auto const kind = static_cast<int>(a[1] & ~kSocketFlags);
    if (a[0] == AF_INET6) {
        return refuse(t, "a socket of IPv6 (of IPv4 they are)", EAFNOSUPPORT);
    }
    bool const tcp = kind == SOCK_STREAM && (a[2] == 0 || a[2] == IPPROTO_TCP);
    bool const udp = kind == SOCK_DGRAM && (a[2] == 0 || a[2] == IPPROTO_UDP);
    if (!tcp && !udp) {
        return kind == SOCK_RAW ? refuse(t, "a raw socket of IP", EPERM)
                                : refuse(t, "an IP socket of another protocol than TCP and UDP", EPROTONOSUPPORT);
    }
    Call other = t.call;
    other.arguments = {AF_UNIX, static_cast<std::uint64_t>(kind) | (a[1] & kSocketFlags), 0};
    replace(t.tid, other);
    t.on_exit = Thread::OnExit::new_ip_socket;
    return Next::go_to_exit;
}

std::optional<CallTable::Next> CallTable::ip_call(Thread& t) {
    NamedIp const named = ip_socket_of(t);
    if (named.socket == nullptr) {
        return std::nullopt;
    }
    IpSocket& socket = *named.socket;
    std::optional<std::int64_t> result;
    switch (t.call.number) {
    case SYS_bind:
        result = ip_calls_->bind(t, socket);
        break;
    case SYS_listen:
        result = ip_calls_->listen(t, socket, named.file);
        break;
    case SYS_getsockname:
    case SYS_getpeername:
        result = ip_calls_->name(t, socket, t.call.number == SYS_getpeername);
        break;
    case SYS_setsockopt:
        result = ip_calls_->option(t, socket);
        break;
    case SYS_getsockopt:
        result = ip_calls_->look_at_option(t, socket);
        break;
    case SYS_ioctl:
        result = ip_calls_->control(t, socket);
        break;
    case SYS_sendfile: // programs then copy by read and write
        result = -EINVAL;
        break;
    case SYS_connect: {
        bool const waits = !does_not_block(named.file);
        result = ip_calls_->connect(t, socket, named.file, waits);
        if (!result) {
            t.interests = {{static_cast<int>(t.call.arguments[0]), POLLOUT}};
            auto const patience = timeout_ns(named.file, SO_SNDTIMEO);
            return hold_until(t, patience ? std::optional{clock_.now_ns() + *patience} : std::nullopt);
        }
        break;
    }
    default:
        break;
    }
    if (result) {
        answer(t.tid, *result);
    }
    return Next::go;
}

CallTable::Next CallTable::take_connection(Thread& t) {
    t.room = t.call.arguments[2] == 0 ? 0 : value_at<socklen_t>(t.tid, t.call.arguments[2]);
    t.on_exit = Thread::OnExit::ip_accepted;
    return Next::go_to_exit;
}

CallTable::Next CallTable::ip_transfer(Thread& t, IpSocket& socket, UniqueFd const& file, short event, bool waits) {
    auto const patience = event == POLLIN ? exact_receive_timeout_ns(file) : timeout_ns(file, SO_SNDTIMEO);
    auto const hold = [&] {
        t.interests = {{static_cast<int>(t.call.arguments[0]), event}};
        return hold_until(t, patience ? std::optional{clock_.now_ns() + *patience} : std::nullopt);
    };
    if (is_accept(t)) {
        bool const is_there = is_ready(file, event);
        if (!waits && !is_there) {
            look_again();
        }
        return !waits || is_there ? take_connection(t) : hold();
    }
    auto const result =
        event == POLLOUT ? ip_calls_->send(t, socket, file, waits) : ip_calls_->receive(t, socket, file, waits);
    if (!result) {
        return hold();
    }
    if (*result == -EAGAIN) {
        look_again();
    }
    answer(t.tid, *result);
    return Next::go;
}

/// A socket has been made, or a connection accepted.
void CallTable::ip_leave(Thread& t, Thread::OnExit done, std::int64_t result) {
    UniqueFd const file = descriptors(t.process).copy_of(static_cast<int>(result));
    if (done == Thread::OnExit::new_ip_socket) {
        bool const stream = (t.call.arguments[1] & ~kSocketFlags) == SOCK_STREAM;
        report_.refused["an IP socket (no room)"] += result < 0 || ip_->add(file, stream) ? 0 : 1;
        restore(t.tid, t.call);
        return;
    }
    NamedIp const named = ip_socket_of(t);
    if (result >= 0 && named.socket != nullptr && !named.socket->unaccepted.empty()) {
        put_address(t.tid, t.call.arguments[1], t.call.arguments[2], t.room, named.socket->unaccepted.front().remote);
        ip_->accepted(*named.socket, file);
    }
}

/// What it waits for is there, or its time is over.
CallTable::Next CallTable::ip_release(Thread& t, IpSocket& socket, UniqueFd const& file, bool over) {
    if (t.call.number == SYS_connect) {
        answer(t.tid, IpCalls::connected(socket));
        return Next::go;
    }
    if (over) {
        answer(t.tid, t.progress > 0 ? static_cast<std::int64_t>(t.progress) : -EAGAIN);
        return Next::go;
    }
    if (is_accept(t)) {
        return take_connection(t);
    }
    auto const result = t.what->treatment == Treatment::send ? ip_calls_->send(t, socket, file, true)
                                                             : ip_calls_->receive(t, socket, file, true);
    if (!result) {
        return Next::hold;
    }
    answer(t.tid, *result);
    return Next::go;
}

} // namespace gridspace::timebox

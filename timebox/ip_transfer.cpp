// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What programs send and receive by IP sockets.
#include "timebox/ip_address.hpp"
#include "timebox/ip_calls.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace gridspace::timebox {
namespace {

constexpr std::size_t kAtOnce = 1U << 20U;

/// The message without its first octets.
Message behind(Message message, std::size_t octets) {
    std::vector<iovec> parts;
    for (iovec part : message.parts) {
        std::size_t const skipped = std::min<std::size_t>(octets, part.iov_len);
        octets -= skipped;
        part.iov_base = static_cast<char*>(part.iov_base) + skipped;
        part.iov_len -= skipped;
        if (part.iov_len > 0) {
            parts.push_back(part);
        }
    }
    message.parts = std::move(parts);
    return message;
}

/// One call may send several; a stream knows no messages, so the first stands for itself.
std::int64_t told(Thread const& t, Message const& message, std::size_t octets) {
    if (message.count_at == 0) {
        return static_cast<std::int64_t>(octets);
    }
    put(t.tid, message.count_at, static_cast<std::uint32_t>(octets));
    return 1;
}

} // namespace

std::optional<std::int64_t> IpCalls::send(Thread& t, IpSocket& socket, UniqueFd const& file, bool waits) {
    if (socket.stream) {
        return send_stream(t, socket, file, waits);
    }
    return each_message(t.tid, t.call,
                        [&](Message const& message) { return std::optional{send_datagram(t, socket, message)}; });
}

std::optional<std::int64_t> IpCalls::send_stream(Thread& t, IpSocket& socket, UniqueFd const& file, bool waits) {
    int const flags = flags_of(t.call);
    if ((flags & MSG_OOB) != 0) {
        return refuse("urgent data of TCP (MSG_OOB)", EOPNOTSUPP);
    }
    std::vector<Message> const messages = messages_of(t.tid, t.call);
    if (messages.empty()) {
        return 0;
    }
    std::vector<std::uint8_t> octets;
    if (!gather(t.tid, behind(messages.front(), t.progress), octets)) {
        return -EFAULT;
    }
    for (std::size_t done = 0; true;) {
        ssize_t const sent =
            ::send(file.get(), octets.data() + done, octets.size() - done, MSG_DONTWAIT | MSG_NOSIGNAL);
        int const error = sent < 0 ? errno : 0;
        if (sent >= 0) {
            done += static_cast<std::size_t>(sent);
            t.progress += static_cast<std::size_t>(sent);
        }
        sockets_.pump(); // it leaves now, and may make room
        if (done == octets.size()) {
            return told(t, messages.front(), t.progress);
        }
        if (sent > 0) {
            continue;
        }
        if (error == EAGAIN) {
            if (waits) {
                return std::nullopt;
            }
            return t.progress > 0 ? told(t, messages.front(), t.progress) : -EAGAIN;
        }
        if (t.progress > 0) {
            return told(t, messages.front(), t.progress);
        }
        if (socket.error != 0) {
            return -std::exchange(socket.error, 0);
        }
        if (error != EPIPE && error != ENOTCONN && error != ECONNRESET) {
            return -error;
        }
        if ((flags & MSG_NOSIGNAL) == 0) {
            ::syscall(SYS_tgkill, t.process, t.tid, SIGPIPE);
        }
        return -EPIPE;
    }
}

std::int64_t IpCalls::send_datagram(Thread const& t, IpSocket& socket, Message const& message) {
    std::optional<IpEndpoint> to;
    if (message.name != 0) {
        NamedAddress const named = address_at(t.tid, message.name, message.name_size);
        if (named.error != 0 || named.family == AF_UNSPEC) {
            return named.error != 0 ? -named.error : -EINVAL;
        }
        to = named.endpoint;
    }
    std::vector<std::uint8_t> octets;
    if (!gather(t.tid, message, octets)) {
        return -EFAULT;
    }
    int const error = sockets_.send(socket, octets, to);
    return error != 0 ? -error : static_cast<std::int64_t>(octets.size());
}

std::optional<std::int64_t> IpCalls::receive(Thread& t, IpSocket& socket, UniqueFd const& file, bool waits) {
    if (socket.stream) {
        return receive_stream(t, socket, file, waits);
    }
    int const flags = flags_of(t.call);
    if ((flags & MSG_ERRQUEUE) != 0) {
        return -EAGAIN;
    }
    bool any = false;
    std::int64_t const result = each_message(t.tid, t.call, [&](Message const& message) -> std::optional<std::int64_t> {
        int const error = any ? 0 : socket.udp->take_error();
        if (error == 0 && socket.udp->queue().empty()) {
            return std::nullopt;
        }
        any = true;
        return error != 0 ? -error : receive_datagram(t, socket, message, flags, (flags & MSG_PEEK) != 0);
    });
    sockets_.taken(socket, file);
    return any ? std::optional{result} : waits ? std::nullopt : std::optional<std::int64_t>{-EAGAIN};
}

std::int64_t IpCalls::receive_datagram(Thread const& t, IpSocket& socket, Message const& message, int flags,
                                       bool keep) {
    Datagram const datagram = keep ? socket.udp->queue().front() : socket.udp->pop();
    std::size_t const copied = std::min(datagram.octets.size(), room_of(message));
    if (!scatter(t.tid, message, std::span{datagram.octets}.first(copied))) {
        return -EFAULT;
    }
    sockaddr_in const from = to_sockaddr(datagram.from);
    if (message.name != 0) {
        (void)write_memory(t.tid, message.name, &from, std::min<std::size_t>(message.name_size, sizeof from));
    }
    if (message.name_size_at != 0) {
        put(t.tid, message.name_size_at, static_cast<socklen_t>(sizeof from));
    }
    if (message.header != 0) {
        msghdr fields = message.fields;
        int more = copied < datagram.octets.size() ? MSG_TRUNC : 0;
        std::size_t beside = 0;
        if (socket.packet_info) {
            std::array<std::uint8_t, CMSG_SPACE(sizeof(in_pktinfo))> control{};
            cmsghdr const head{CMSG_LEN(sizeof(in_pktinfo)), IPPROTO_IP, IP_PKTINFO};
            in_pktinfo info{};
            info.ipi_addr.s_addr = htonl(datagram.to);
            info.ipi_spec_dst.s_addr = htonl(sockets_.stack().link().address);
            info.ipi_ifindex = sockets_.interface();
            std::memcpy(control.data(), &head, sizeof head);
            std::memcpy(control.data() + CMSG_LEN(0), &info, sizeof info);
            beside = control.size() <= fields.msg_controllen ? control.size() : 0;
            more |= beside == 0 ? MSG_CTRUNC : 0;
            (void)write_memory(t.tid, reinterpret_cast<std::uint64_t>(fields.msg_control), control.data(), beside);
        }
        fields.msg_controllen = beside;
        fields.msg_namelen = fields.msg_name != nullptr ? sizeof from : 0;
        fields.msg_flags = more;
        put(t.tid, message.header, fields);
    }
    return static_cast<std::int64_t>((flags & MSG_TRUNC) != 0 ? datagram.octets.size() : copied);
}

std::optional<std::int64_t> IpCalls::receive_stream(Thread& t, IpSocket& socket, UniqueFd const& file, bool waits) {
    int const flags = flags_of(t.call);
    if ((flags & MSG_OOB) != 0) {
        return refuse("urgent data of TCP (MSG_OOB)", EINVAL);
    }
    std::vector<Message> const messages = messages_of(t.tid, t.call);
    if (messages.empty()) {
        return 0;
    }
    Message const message = behind(messages.front(), t.progress);
    bool const all = (flags & MSG_WAITALL) != 0 && (flags & MSG_PEEK) == 0 && waits;
    std::vector<std::uint8_t> octets(std::min(room_of(message), kAtOnce));
    ssize_t const got = ::recv(file.get(), octets.data(), octets.size(), MSG_DONTWAIT | (flags & MSG_PEEK));
    int const error = got < 0 ? errno : 0;
    if (got > 0) {
        if (!scatter(t.tid, message, std::span{octets}.first(static_cast<std::size_t>(got)))) {
            return -EFAULT;
        }
        t.progress += static_cast<std::size_t>(got);
        sockets_.pump(); // there is room now
        if (all && t.progress < room_of(messages.front())) {
            return std::nullopt;
        }
    } else if (error == EAGAIN && waits) {
        return std::nullopt;
    } else if (t.progress == 0 && !octets.empty()) {
        if (socket.error != 0) {
            return -std::exchange(socket.error, 0);
        }
        if (error != 0) {
            return error == EINVAL ? -ENOTCONN : -error;
        }
        if (socket.state == IpSocket::State::idle || socket.state == IpSocket::State::listening) {
            return -ENOTCONN;
        }
    }
    if (message.name_size_at != 0) {
        put(t.tid, message.name_size_at, socklen_t{0}); // tcp(7) returns no address
    }
    if (message.header != 0) {
        msghdr fields = message.fields;
        fields.msg_namelen = 0;
        fields.msg_controllen = 0;
        fields.msg_flags = 0;
        put(t.tid, message.header, fields);
    }
    return told(t, messages.front(), t.progress);
}

} // namespace gridspace::timebox

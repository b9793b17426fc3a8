// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/ip/ip_sockets.hpp"

#include "timebox/ip/stand_in.hpp"

#include <algorithm>
#include <cerrno>
#include <sys/socket.h>
#include <sys/stat.h>

namespace gridspace::timebox {

IpSockets::IpSockets(IpLink const& link, int interface, std::uint64_t seed, IpStack::Send send)
    : stack_{link, seed, std::move(send)}, interface_{interface},
      meeting_{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)},
      datagram_probe_{::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)}, buffer_(65'536) {
    meeting_address_ = give_address(meeting_);
    ::listen(meeting_.get(), 1);
}

bool IpSockets::add(UniqueFd const& file, bool stream) {
    std::string address = give_address(file);
    if (address.empty()) {
        return false;
    }
    forget_closed();
    IpSocket& socket = sockets_.emplace_back();
    socket.inode = socket_inode_of(file);
    socket.stand_in = std::move(address);
    socket.stream = stream;
    if (stream) {
        socket.tcp = std::make_unique<TcpEnd>();
    } else {
        socket.udp = udp_.make();
    }
    return true;
}

IpSocket* IpSockets::find(UniqueFd const& file) {
    std::uint64_t const inode = sockets_.empty() ? 0 : socket_inode_of(file);
    auto const it = std::ranges::find(sockets_, inode, &IpSocket::inode);
    return inode == 0 || it == sockets_.end() ? nullptr : &*it;
}

void IpSockets::arrives(std::int64_t at_ns, std::span<std::uint8_t const> frame) {
    coming_.push_back({at_ns, {frame.begin(), frame.end()}});
}

void IpSockets::bring_up_to(std::int64_t now_ns) {
    pump(); // what was written before comes before what is due
    now_ns_ = std::max(now_ns_, now_ns);
    while (!coming_.empty() && coming_.front().at_ns <= now_ns_) {
        forget_closed();
        stack_.elapse_to(coming_.front().at_ns);
        stack_.receive(coming_.front().frame);
        coming_.pop_front();
        pump();
    }
    stack_.elapse_to(now_ns_);
    pump();
}

void IpSockets::end_instant() {
    stack_.acknowledge();
    pump();
}

std::int64_t IpSockets::next_ns() const {
    std::int64_t const timer_ns = stack_.next_ns();
    return coming_.empty() ? timer_ns : std::min(timer_ns, coming_.front().at_ns);
}

bool IpSockets::is_own(std::uint32_t address) const {
    return address == 0 || (address >> 24U) == 127 || address == stack_.link().address;
}

int IpSockets::bind(IpSocket& socket, IpEndpoint const& to) {
    forget_closed();
    bool const to_many = !socket.stream && ((to.address >> 28U) == 0xE || stack_.reaches(to.address));
    if (!is_own(to.address) && !(to_many && !stack_.link().neighbours.contains(to.address))) {
        return EADDRNOTAVAIL;
    }
    if (socket.stream) {
        if (socket.state != IpSocket::State::idle || socket.tcp->local().port != 0) {
            return EINVAL;
        }
        int const error = socket.tcp->bind(to, socket.reuse);
        socket.local = socket.tcp->local();
        return error;
    }
    return socket.udp->local().port != 0 ? EINVAL : socket.udp->bind(to, socket.reuse);
}

int IpSockets::listen(IpSocket& socket, UniqueFd const& file, int backlog) {
    if (!socket.stream) {
        return EOPNOTSUPP;
    }
    if (socket.state == IpSocket::State::listening) {
        return ::listen(file.get(), backlog) == 0 ? 0 : errno;
    }
    if (socket.state != IpSocket::State::idle) {
        return EINVAL;
    }
    if (int const error = TcpListener::listen(*socket.tcp, socket.listener); error != 0) {
        return error;
    }
    socket.local = socket.listener->local();
    socket.state = IpSocket::State::listening;
    return ::listen(file.get(), backlog) == 0 ? 0 : errno;
}

int IpSockets::connect(IpSocket& socket, UniqueFd const& file, std::optional<IpEndpoint> to) {
    if (!socket.stream) {
        if (!to) {
            socket.udp->disconnect();
            return 0;
        }
        return stack_.reaches(to->address) || to->address == 0 ? socket.udp->connect(*to) : ENETUNREACH;
    }
    switch (socket.state) {
    case IpSocket::State::connecting:
        return EALREADY;
    case IpSocket::State::open:
    case IpSocket::State::listening:
        return EISCONN;
    case IpSocket::State::over:
        return socket.error != 0 ? std::exchange(socket.error, 0) : EISCONN;
    case IpSocket::State::idle:
        break;
    }
    if (!to) {
        return 0;
    }
    if (to->address == 0) {
        to->address = 0x7F000001; // as Linux takes it
    }
    if (!stack_.reaches(to->address)) {
        return EHOSTUNREACH;
    }
    forget_closed();
    if (!connect_to(file, meeting_address_)) {
        return errno;
    }
    socket.ours = UniqueFd{::accept4(meeting_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK)};
    socket.remote = *to;
    if (int const error = socket.tcp->connect(*to); error != 0) {
        fail(socket, 0);
        return error;
    }
    socket.tcp->set(socket.tcp_options);
    socket.local = socket.tcp->local();
    socket.state = IpSocket::State::connecting;
    make_unwritable(file);
    pump();
    return socket.state == IpSocket::State::connecting ? EINPROGRESS : socket.error;
}

int IpSockets::send(IpSocket& socket, std::span<std::uint8_t const> octets, std::optional<IpEndpoint> to) {
    if (to && to->address == 0) {
        to->address = 0x7F000001;
    }
    if (to && !stack_.reaches(to->address)) {
        return EHOSTUNREACH;
    }
    if (to && stack_.is_broadcast(to->address) && !socket.broadcast) {
        return EACCES;
    }
    if (int const error = socket.udp->take_error(); error != 0) {
        return error;
    }
    int const error = socket.udp->send(octets, to);
    stack_.settle();
    return error;
}

int IpSockets::join(IpSocket& socket, std::uint32_t group) {
    if ((group >> 28U) != 0xE) {
        return EINVAL;
    }
    if (!socket.groups.insert(group).second) {
        return EADDRINUSE;
    }
    stack_.join(group);
    return 0;
}

int IpSockets::leave(IpSocket& socket, std::uint32_t group) {
    if (socket.groups.erase(group) == 0) {
        return EADDRNOTAVAIL;
    }
    stack_.leave(group);
    return 0;
}

void IpSockets::accepted(IpSocket& listener, UniqueFd const& file) {
    struct stat status{};
    if (listener.unaccepted.empty() || ::fstat(file.get(), &status) != 0) {
        return;
    }
    listener.unaccepted.front().inode = status.st_ino;
    sockets_.splice(sockets_.end(), listener.unaccepted, listener.unaccepted.begin());
}

void IpSockets::apply_options(IpSocket& socket) {
    if (socket.stream) {
        socket.tcp->set(socket.tcp_options);
        return;
    }
    socket.udp->set_header(socket.tcp_options.service, socket.tcp_options.time_to_live);
    socket.udp->set_broadcast(socket.broadcast);
    socket.udp->set_multicast(socket.multicast_ttl, socket.multicast_loop);
    socket.udp->room = static_cast<std::size_t>(socket.receive_room) * 2;
}

bool IpSockets::is_there(IpSocket const& socket) const {
    return socket.ours || socket.stand_in.empty() || address_is_taken(socket.stand_in, socket.stream);
}

/// Their ports are free again, and nobody is connected to them.
void IpSockets::forget_closed() {
    for (auto it = sockets_.begin(); it != sockets_.end();) {
        if (is_there(*it)) {
            ++it;
            continue;
        }
        for (std::uint32_t const group : it->groups) {
            stack_.leave(group);
        }
        it = sockets_.erase(it);
    }
}

} // namespace gridspace::timebox

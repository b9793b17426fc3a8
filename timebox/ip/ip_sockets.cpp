// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/ip/ip_sockets.hpp"

#include "timebox/ip/stand_in.hpp"

#include <algorithm>
#include <cerrno>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gridspace::timebox {
namespace {

constexpr int kMostMarks = 8; // the kernel's queue has room for ten
constexpr std::size_t kAtOnce = 65'536;

} // namespace

IpSockets::IpSockets(IpLink const& link, int interface, std::uint64_t seed, IpStack::Send send)
    : stack_{link, seed, std::move(send)}, interface_{interface},
      meeting_{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)},
      datagram_probe_{::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)}, buffer_(kAtOnce) {
    meeting_address_ = give_address(meeting_);
    ::listen(meeting_.get(), 1);
}

bool IpSockets::add(UniqueFd const& file, bool stream) {
    struct stat status{};
    std::string address = give_address(file);
    if (address.empty() || ::fstat(file.get(), &status) != 0) {
        return false;
    }
    forget_closed();
    IpSocket& socket = sockets_.emplace_back();
    socket.inode = status.st_ino;
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
    struct stat status{};
    if (sockets_.empty() || !file || ::fstat(file.get(), &status) != 0 || !S_ISSOCK(status.st_mode)) {
        return nullptr;
    }
    auto const it =
        std::find_if(sockets_.begin(), sockets_.end(), [&](IpSocket const& s) { return s.inode == status.st_ino; });
    return it == sockets_.end() ? nullptr : &*it;
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

void IpSockets::pump() {
    for (bool moved = true; moved;) {
        moved = false;
        for (auto it = sockets_.begin(); it != sockets_.end();) {
            IpSocket& socket = *it++;
            moved = pump(socket) || moved;
            for (auto child = socket.unaccepted.begin(); child != socket.unaccepted.end(); ++child) {
                moved = pump(*child) || moved;
            }
            // One that a listener has got has no name by which it could be asked for.
            bool const gone = socket.stream ? socket.stand_in.empty() && socket.state == IpSocket::State::over &&
                                                  (socket.told_end || socket.error == 0)
                                            : !mark(socket);
            if (gone) {
                sockets_.erase(std::prev(it));
            }
        }
        stack_.settle();
    }
}

bool IpSockets::pump(IpSocket& socket) {
    switch (socket.state) {
    case IpSocket::State::listening: {
        bool const any = !socket.listener->accepted().empty();
        while (!socket.listener->accepted().empty()) {
            accept(socket, std::move(socket.listener->accepted().front()));
            socket.listener->accepted().pop_front();
        }
        return any;
    }
    case IpSocket::State::connecting:
        if (socket.tcp->is_connected()) {
            socket.state = IpSocket::State::open;
            socket.local = socket.tcp->local();
            make_writable(socket.ours);
            return true;
        }
        if (socket.tcp->has_ended()) {
            fail(socket, socket.tcp->error());
            return true;
        }
        return false;
    case IpSocket::State::open:
        return pump_open(socket);
    default:
        return false;
    }
}

void IpSockets::accept(IpSocket& listener, std::unique_ptr<TcpEnd> end) {
    UniqueFd ours{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
    if (!connect_to(ours, listener.stand_in)) { // its queue is full, or it has been closed
        end->reset();
        return;
    }
    IpSocket& child = listener.unaccepted.emplace_back();
    child.stream = true;
    child.state = IpSocket::State::open;
    child.local = end->local();
    child.remote = end->remote();
    child.tcp = std::move(end);
    child.tcp_options = listener.tcp_options;
    child.ours = std::move(ours);
    child.tcp->set(child.tcp_options);
}

bool IpSockets::pump_open(IpSocket& socket) {
    bool const moved = to_program(socket);
    if (socket.tcp->has_ended() && socket.tcp->error() != 0 && socket.tcp->received().empty()) {
        fail(socket, socket.tcp->error());
        return true;
    }
    return (socket.ours && from_program(socket)) || moved;
}

bool IpSockets::to_program(IpSocket& socket) {
    bool moved = false;
    while (!socket.tcp->received().empty()) {
        auto const& octets = socket.tcp->received();
        ssize_t const sent = ::send(socket.ours.get(), octets.data(), octets.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
        if (sent < 0 && errno != EPIPE) {
            return moved; // it has not read yet what is there
        }
        socket.tcp->take(sent < 0 ? octets.size() : static_cast<std::size_t>(sent));
        moved = true;
    }
    if (socket.tcp->peer_has_finished() && !socket.told_end) {
        ::shutdown(socket.ours.get(), SHUT_WR);
        socket.told_end = true;
        moved = true;
    }
    return moved;
}

bool IpSockets::from_program(IpSocket& socket) {
    bool moved = false;
    while (true) {
        std::size_t const room = std::min(socket.tcp->has_ended() ? kAtOnce : socket.tcp->room(), kAtOnce);
        if (room == 0) {
            pollfd look{socket.ours.get(), POLLIN, 0}; // whether it has gone away is to be seen with a full buffer too
            if (::poll(&look, 1, 0) <= 0 || (look.revents & POLLERR) == 0) {
                return moved;
            }
        }
        ssize_t const got = ::recv(socket.ours.get(), buffer_.data(), std::max<std::size_t>(room, 1), MSG_DONTWAIT);
        if (got > 0) {
            (void)socket.tcp->send({buffer_.data(), static_cast<std::size_t>(got)});
            moved = true;
            continue;
        }
        if (got < 0 && errno == EAGAIN) {
            return moved;
        }
        if (got < 0 || socket.resets_at_close) { // closed with something unread (RFC 1122, 4.2.2.13), or as it wants
            pollfd look{socket.ours.get(), 0, 0};
            if (got < 0 || (::poll(&look, 1, 0) > 0 && (look.revents & POLLHUP) != 0)) {
                socket.tcp->reset();
            }
        }
        pollfd look{socket.ours.get(), 0, 0};
        if (::poll(&look, 1, 0) > 0 && (look.revents & (POLLHUP | POLLERR)) != 0 && !socket.told_end) {
            socket.tcp->close(); // nobody reads either
            socket.told_end = true;
        } else {
            socket.tcp->finish();
            if (!socket.told_end) {
                return moved; // the other direction goes on
            }
            socket.tcp->let_go_when_finished();
        }
        socket.ours.reset();
        socket.state = IpSocket::State::over;
        return true;
    }
}

void IpSockets::fail(IpSocket& socket, int error) {
    socket.error = error;
    socket.state = IpSocket::State::over;
    socket.told_end = false; // it lives until it is closed
    socket.ours.reset();
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

bool IpSockets::mark(IpSocket& socket) {
    std::size_t const wanted = socket.udp->queue().size() + (socket.udp->has_error() ? 1 : 0);
    while (socket.marks < kMostMarks && static_cast<std::size_t>(socket.marks) < wanted) {
        if (!send_to(datagram_probe_, socket.stand_in)) {
            return errno != ECONNREFUSED;
        }
        ++socket.marks;
    }
    return true;
}

void IpSockets::taken(IpSocket& socket, UniqueFd const& file) {
    std::size_t const left = socket.udp->queue().size() + (socket.udp->has_error() ? 1 : 0);
    while (socket.marks > 0 && static_cast<std::size_t>(socket.marks) > left) {
        char octet = 0;
        socket.marks = ::recv(file.get(), &octet, 1, MSG_DONTWAIT) == 1 ? socket.marks - 1 : 0;
    }
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

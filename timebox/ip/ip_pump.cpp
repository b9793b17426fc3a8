// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What goes back and forth between the programs and the stack.
#include "timebox/ip/ip_sockets.hpp"

#include "timebox/ip/stand_in.hpp"

#include <algorithm>
#include <cerrno>
#include <poll.h>
#include <sys/socket.h>

namespace gridspace::timebox {
namespace {

short events_of(UniqueFd const& file) {
    pollfd look{file.get(), POLLIN, 0};
    return ::poll(&look, 1, 0) > 0 ? look.revents : short{0};
}

} // namespace

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
        std::size_t const room =
            std::min(socket.tcp->has_ended() ? buffer_.size() : socket.tcp->room(), buffer_.size());
        if (room == 0 && (events_of(socket.ours) & POLLERR) == 0) {
            return moved;
        }
        ssize_t const got = room > 0 ? ::recv(socket.ours.get(), buffer_.data(), room, MSG_DONTWAIT) : -1;
        if (got > 0) {
            (void)socket.tcp->send({buffer_.data(), static_cast<std::size_t>(got)});
            moved = true;
            continue;
        }
        if (got < 0 && room > 0 && errno == EAGAIN) {
            return moved;
        }
        bool const closed = (events_of(socket.ours) & (POLLHUP | POLLERR)) != 0;
        if (got < 0 ||
            (closed && socket.resets_at_close)) { // with something unread (RFC 1122, 4.2.2.13), or as it wants
            socket.tcp->reset();
        }
        if (closed && !socket.told_end) {
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

} // namespace gridspace::timebox

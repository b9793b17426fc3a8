// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "timebox/ip/ip_socket.hpp"
#include "timebox/ip/ip_stack.hpp"

#include <deque>
#include <list>
#include <optional>

namespace gridspace::timebox {

/// All IP sockets in a box, between their stand-ins and the stack.
class IpSockets {
  public:
    /// `interface`: the kernel's number of the one that it stands for.
    IpSockets(IpLink const& link, int interface, std::uint64_t seed, IpStack::Send send);

    /// `file`: what the kernel has in its place. False: it could not be prepared.
    bool add(UniqueFd const& file, bool stream);
    [[nodiscard]] IpSocket* find(UniqueFd const& file); ///< nullptr: it is no IP socket

    void arrives(std::int64_t at_ns, std::span<std::uint8_t const> frame);
    /// Brings everything up to now: frames, timers, and what programs have written, read and closed.
    void bring_up_to(std::int64_t now_ns);
    [[nodiscard]] std::int64_t next_ns() const;
    /// Time will go on: nobody does anything more at this instant.
    void end_instant();

    // Each 0, or an error number of the call of that name.
    [[nodiscard]] int bind(IpSocket& socket, IpEndpoint const& to);
    [[nodiscard]] int listen(IpSocket& socket, UniqueFd const& file, int backlog);
    /// EINPROGRESS: it will be writable when it is connected, or has failed.
    [[nodiscard]] int connect(IpSocket& socket, UniqueFd const& file, std::optional<IpEndpoint> to);
    [[nodiscard]] int join(IpSocket& socket, std::uint32_t group);
    [[nodiscard]] int leave(IpSocket& socket, std::uint32_t group);
    [[nodiscard]] int send(IpSocket& socket, std::span<std::uint8_t const> octets, std::optional<IpEndpoint> to);

    /// The program has got the connection that waited longest.
    void accepted(IpSocket& listener, UniqueFd const& file);
    /// A datagram has been read, by way of that file.
    void taken(IpSocket& socket, UniqueFd const& file);
    void apply_options(IpSocket& socket);
    void pump();

    [[nodiscard]] IpStack& stack() { return stack_; }
    [[nodiscard]] int interface() const { return interface_; }

  private:
    bool pump(IpSocket& socket); ///< true: something has moved
    bool pump_open(IpSocket& socket);
    void accept(IpSocket& listener, std::unique_ptr<TcpEnd> end);
    bool to_program(IpSocket& socket);
    bool from_program(IpSocket& socket);
    void fail(IpSocket& socket, int error);
    bool mark(IpSocket& socket); ///< false: it has been closed
    void forget_closed();
    [[nodiscard]] bool is_there(IpSocket const& socket) const;
    [[nodiscard]] bool is_own(std::uint32_t address) const;

    IpStack stack_;
    int interface_;
    UdpEnds udp_;
    UniqueFd meeting_; ///< where our ends of connections come from
    std::string meeting_address_;
    UniqueFd datagram_probe_;     ///< sends marks, and asks for stand-ins of streams
    std::list<IpSocket> sockets_; ///< as they were made
    struct Coming {
        std::int64_t at_ns;
        std::vector<std::uint8_t> frame;
    };
    std::deque<Coming> coming_;
    std::vector<std::uint8_t> buffer_;
    std::int64_t now_ns_{0};
};

} // namespace gridspace::timebox

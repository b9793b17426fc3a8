// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "timebox/ip/ip_sockets.hpp"
#include "timebox/message.hpp"
#include "timebox/thread.hpp"

#include <functional>

namespace gridspace::timebox {

/// The calls of tcp(7), udp(7) and ip(7), answered without the kernel's IP. Each returns what the program gets: a
/// value, or minus an error number. Nothing: it has to wait, or the kernel may answer, as is said there.
class IpCalls {
  public:
    /// `refused(what)`: it is not available, and is reported at the end.
    IpCalls(IpSockets& sockets, std::function<void(std::string const&)> refused)
        : sockets_{sockets}, refused_{std::move(refused)} {}

    /// Nothing: it waits until it can go on, and is called again then.
    [[nodiscard]] std::optional<std::int64_t> send(Thread& t, IpSocket& socket, UniqueFd const& file, bool waits);
    [[nodiscard]] std::optional<std::int64_t> receive(Thread& t, IpSocket& socket, UniqueFd const& file, bool waits);
    /// Nothing: it is on its way.
    [[nodiscard]] std::optional<std::int64_t> connect(Thread const& t, IpSocket& socket, UniqueFd const& file,
                                                      bool waits);
    /// How it came out.
    [[nodiscard]] static std::int64_t connected(IpSocket& socket);

    [[nodiscard]] std::int64_t bind(Thread const& t, IpSocket& socket);
    [[nodiscard]] std::int64_t listen(Thread const& t, IpSocket& socket, UniqueFd const& file);
    [[nodiscard]] std::int64_t name(Thread const& t, IpSocket const& socket, bool peer) const;
    /// Nothing: the kernel's answer is right.
    [[nodiscard]] std::optional<std::int64_t> option(Thread const& t, IpSocket& socket);
    [[nodiscard]] std::optional<std::int64_t> look_at_option(Thread const& t, IpSocket& socket) const;
    [[nodiscard]] std::optional<std::int64_t> control(Thread const& t, IpSocket& socket);

  private:
    [[nodiscard]] std::optional<std::int64_t> send_stream(Thread& t, IpSocket& socket, UniqueFd const& file,
                                                          bool waits);
    [[nodiscard]] std::optional<std::int64_t> receive_stream(Thread& t, IpSocket& socket, UniqueFd const& file,
                                                             bool waits);
    [[nodiscard]] std::int64_t send_datagram(Thread const& t, IpSocket& socket, Message const& message);
    [[nodiscard]] std::int64_t receive_datagram(Thread const& t, IpSocket& socket, Message const& message, int flags,
                                                bool keep);
    [[nodiscard]] std::optional<std::int64_t> ip_option(Thread const& t, IpSocket& socket, int name);
    [[nodiscard]] std::optional<std::int64_t> tcp_option(Thread const& t, IpSocket& socket, int name);
    [[nodiscard]] std::int64_t refuse(std::string const& what, int error) {
        refused_(what);
        return -error;
    }

    IpSockets& sockets_;
    std::function<void(std::string const&)> refused_;
};

} // namespace gridspace::timebox

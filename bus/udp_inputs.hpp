// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/receiving.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gridspace::bus {

/// What a participant hears on a port by UDP. Knows no DDS.
class UdpInput {
  public:
    /// The datagram may be changed; `from` is the sender's IPv4 address and port, in host order.
    using OnDatagram = std::function<void(std::span<std::uint8_t> datagram, std::uint32_t from, std::uint16_t port)>;
    struct Options {
        std::vector<std::string> interfaces; ///< by their IPv4 addresses; not empty
        std::uint16_t port{0};
        std::string group{};             ///< multicast; empty: unicast
        std::uint32_t receive_buffer{0}; ///< of the kernel; 0: as it is
        std::uint32_t longest{65536};    ///< datagram
    };
    /// nullptr when the port is taken.
    [[nodiscard]] static std::unique_ptr<UdpInput> open(Options const& options, OnDatagram on_datagram);

  private:
    struct Socket;
    UdpInput() = default;

  public:
    ~UdpInput();

  private:
    std::vector<std::unique_ptr<Socket>> sockets_;
};

} // namespace gridspace::bus

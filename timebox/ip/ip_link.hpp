// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <map>

namespace gridspace::timebox {

/// An address of IPv4 and a port, both in the host's order.
struct IpEndpoint {
    std::uint32_t address{0};
    std::uint16_t port{0};
    friend auto operator<=>(IpEndpoint const&, IpEndpoint const&) = default;
};

using MacOctets = std::array<std::uint8_t, 6>;

/// The programs of a box on an IPv4 network. Everybody on it knows everybody, so nobody asks (ARP).
struct IpLink {
    std::uint32_t address{0};
    int prefix{24};
    MacOctets mac{};                               ///< not the interface's: the kernel's own IP must not answer
    std::map<std::uint32_t, MacOctets> neighbours; ///< by address
};

} // namespace gridspace::timebox

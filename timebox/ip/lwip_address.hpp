// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <lwip/ip_addr.h>

namespace gridspace::timebox {

[[nodiscard]] inline std::uint32_t address_of(ip_addr_t const& address) {
    return lwip_ntohl(address.u_addr.ip4.addr);
}
[[nodiscard]] inline ip_addr_t lwip_address(std::uint32_t address) {
    ip_addr_t out{};
    out.u_addr.ip4.addr = lwip_htonl(address);
    out.type = IPADDR_TYPE_V4;
    return out;
}

} // namespace gridspace::timebox

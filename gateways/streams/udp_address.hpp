// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "gateways/iec61850/routable.hpp"

#include <optional>
#include <string>

namespace gridspace::streams {

/// Where a stream goes over UDP instead of Ethernet: R-GOOSE and R-SV (IEC 61850-8-1:2011/AMD1:2020).
struct UdpAddress {
    iec61850::Ipv4 group{};
    std::optional<iec61850::Ipv4> source; ///< otherwise that of the sender's interface
    std::uint8_t ttl{16}, dscp{46};

    /// Of frames that are sent where the address is `own`.
    [[nodiscard]] iec61850::RoutableAddress from(iec61850::Ipv4 const& own,
                                                 std::optional<iec61850::VlanTag> const& vlan) const {
        return {{}, {}, group, source.value_or(own), ttl, dscp, vlan};
    }
};

/// "239.192.0.21".
[[nodiscard]] std::optional<iec61850::Ipv4> parse_ipv4(std::string const& text);
/// Whether routers forward what is sent to it.
[[nodiscard]] bool is_routed_group(iec61850::Ipv4 const& address);

/// The key `udp`.
void describe(config::Fields& f, std::optional<UdpAddress>& udp);

} // namespace gridspace::streams

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/routable_sender.hpp"
#include "gateways/port/wire_config.hpp"

#include <vector>

namespace gridspace::gateways {

/// The streams of a process that go over UDP, as it sends them. A stream is recognised by ethertype, destination and
/// APPID. One thread at a time.
class RoutedStreams {
  public:
    RoutedStreams() = default;
    /// `own`: the address of those that name no source.
    RoutedStreams(std::vector<streams::Stream> const& streams, iec61850::Ipv4 const& own);

    [[nodiscard]] bool empty() const { return streams_.empty(); }
    /// What is sent for an Ethernet frame of GOOSE or SV: a datagram, in `memory`, or the frame as it is.
    [[nodiscard]] iec61850::Octets on_the_wire(iec61850::Octets frame, std::vector<std::uint8_t>& memory);

  private:
    struct Routed {
        std::uint16_t ethertype{0}, app_id{0};
        iec61850::Mac destination;
        iec61850::RoutableSender sender;
    };
    std::vector<Routed> streams_;
};

/// Of a process at its place on the wire, whose address is `mac`. Without an IPv4 address of its interface it has a
/// link-local one that follows from `mac` (RFC 3927).
[[nodiscard]] RoutedStreams routed_streams(WireConfig const& wire, iec61850::Mac const& mac);

} // namespace gridspace::gateways

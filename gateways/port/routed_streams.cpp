// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/port/routed_streams.hpp"

#include "gateways/ethernet/interface.hpp"

#include <algorithm>

namespace gridspace::gateways {

RoutedStreams::RoutedStreams(std::vector<streams::Stream> const& streams, iec61850::Ipv4 const& own) {
    for (streams::Stream const& stream : streams) {
        if (stream.udp) {
            streams_.push_back({stream.ethertype(), stream.address.app_id, stream.address.destination,
                                iec61850::RoutableSender{stream.udp->from(own, stream.address.vlan)}});
        }
    }
}

iec61850::Octets RoutedStreams::on_the_wire(iec61850::Octets frame, std::vector<std::uint8_t>& memory) {
    iec61850::FrameHeader header;
    if (streams_.empty() || !iec61850::decode_header(frame, header)) {
        return frame;
    }
    auto const routed = std::find_if(streams_.begin(), streams_.end(), [&](Routed const& r) {
        return r.ethertype == header.ethertype && r.app_id == header.app_id && r.destination == header.destination;
    });
    if (routed == streams_.end()) {
        return frame;
    }
    routed->sender.wrap(header, memory);
    return memory;
}

RoutedStreams routed_streams(WireConfig const& wire, iec61850::Mac const& mac) {
    if (std::ranges::none_of(wire.streams, [](streams::Stream const& s) { return s.udp.has_value(); })) {
        return {};
    }
    auto const third = static_cast<std::uint8_t>(1 + mac.octets[4] % 254); // 169.254.0.x and .255.x are reserved
    iec61850::Ipv4 const link_local{169, 254, third, mac.octets[5]};
    return {wire.streams, ethernet::interface_ipv4(wire.interface).value_or(link_local)};
}

} // namespace gridspace::gateways

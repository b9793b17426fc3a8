// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/routable.hpp"

namespace gridspace::iec61850 {

/// Sends the messages of one control block over UDP: each in a datagram and a session PDU of its own, which are
/// numbered.
class RoutableSender {
  public:
    /// `address`: the destination's Ethernet address and the source's are written here.
    explicit RoutableSender(RoutableAddress const& address) : address_{address} {}

    /// The frame that carries the message of `message`, an Ethernet frame of GOOSE or SV, in the place of what is in
    /// `out`. Allocates nothing once `out` has grown.
    void wrap(FrameHeader const& message, std::vector<std::uint8_t>& out) {
        address_.destination = address_.group();
        address_.source = message.source;
        session_.goose = message.ethertype == kGooseEthertype;
        RoutablePayload const payload{session_.goose, message.simulated(), message.app_id, message.apdu};
        out.clear();
        append_udp_header(address_, out);
        append_routable(session_, {&payload, 1}, out);
        complete_udp_frame(out);
        ++session_.spdu_number;
    }

  private:
    RoutableAddress address_;
    SessionHeader session_;
};

} // namespace gridspace::iec61850

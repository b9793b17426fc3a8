// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/ethernet/port.hpp"
#include "gateways/port/frame_authentication.hpp"
#include "gateways/port/routed_streams.hpp"
#include "gateways/prp/redundancy_trailer.hpp"

#include <array>
#include <atomic>
#include <span>
#include <vector>

namespace gridspace::gateways {

/// Sends frames in real time from a thread of its own, where the process is on the wire: once, or with PRP on both
/// networks; with its code where its stream is authenticated; in a datagram where it goes over UDP. One thread at a
/// time.
class FrameSender {
  public:
    /// `sequence`: of the process's redundancy control trailers, `authentication`: of its frames (may be none). Both
    /// are for all its senders and must outlive this.
    [[nodiscard]] static Result<FrameSender> open(WireConfig const& wire, std::atomic<std::uint16_t>& sequence,
                                                  FrameAuthentication* authentication);

    /// Hands frames to the kernel, all of a network in one call where possible. Allocates nothing once its buffers have
    /// grown.
    void send(std::span<iec61850::Octets const> frames);
    void send(iec61850::Octets frame) { send(std::span{&frame, 1}); }
    /// Looks after the links; a few times a second.
    void maintain();

  private:
    FrameSender(std::atomic<std::uint16_t>& sequence, FrameAuthentication* authentication)
        : sequence_{&sequence}, authentication_{authentication} {}

    [[nodiscard]] std::span<iec61850::Octets const> with_codes(std::span<iec61850::Octets const> frames);
    [[nodiscard]] std::span<iec61850::Octets const> on_the_wire(std::span<iec61850::Octets const> frames);

    std::atomic<std::uint16_t>* sequence_;
    FrameAuthentication* authentication_;
    std::vector<std::vector<std::uint8_t>> signed_;
    std::vector<iec61850::Octets> signed_batch_;
    RoutedStreams routed_;
    std::vector<std::vector<std::uint8_t>> datagrams_;
    std::vector<iec61850::Octets> routed_batch_;
    std::vector<ethernet::Port> ports_;                                  ///< one, or networks A and B
    std::array<std::vector<std::vector<std::uint8_t>>, 2> with_trailer_; ///< by network
    std::vector<iec61850::Octets> batch_;
};

} // namespace gridspace::gateways

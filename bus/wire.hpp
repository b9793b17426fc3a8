// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/lockstep/wire_book.hpp"
#include "bus/node.hpp"
#include "common/time.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gridspace::bus {

using lockstep::WireFrame;

/// The receiving end of one ethertype on one link as far as the simulation clock is concerned; sockets are somebody
/// else's. In lockstep a frame becomes visible in the tick that contains its send time, ordered by (send time, octets),
/// and a frame that no process of the run has announced never does.
class WireReader {
  public:
    /// `ethertype`: in host order, 0x88ba or 0x88b8. Before Node::start; must not outlive the node.
    WireReader(Node& node, std::string link, std::uint16_t ethertype);
    ~WireReader();
    WireReader(WireReader const&) = delete;
    WireReader& operator=(WireReader const&) = delete;

    /// In real time nobody waits for this reader: what comes when so many octets wait already is dropped, and counted.
    void bound(std::size_t octets);
    [[nodiscard]] std::uint64_t dropped() const;
    /// Lockstep: so many frames from addresses that are not of the run came faster than they could be fetched.
    void not_fetched(std::uint64_t total);
    /// From the receiving thread. No allocation once its buffers have grown. False: there was no room for it.
    bool push(std::span<std::byte const> frame, std::int64_t kernel_ns, std::uint32_t port = 0,
              std::int64_t arrived_ns = 0);
    /// What is due, valid until the next call.
    [[nodiscard]] std::span<WireFrame const* const> take();
    /// Lockstep: the earliest time of the frames that are here and not due yet.
    [[nodiscard]] std::optional<SimTime> next() const;

    struct Impl;

  private:
    std::shared_ptr<Impl> impl_;
};

/// Enters frames that this process sends into its ledger.
class WireWriter {
  public:
    WireWriter(Node& node, std::string link, std::uint16_t ethertype);
    /// `frame` leaves (lockstep: with simulated send time `at`). Before the frame is handed to the kernel or after, but
    /// within the same tick.
    void sent(std::span<std::byte const> frame, SimTime at);

  private:
    Node& node_;
    std::size_t slot_;
};

} // namespace gridspace::bus

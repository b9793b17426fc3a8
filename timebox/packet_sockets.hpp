// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "timebox/packet_link.hpp"
#include "timebox/packet_socket.hpp"

#include <deque>
#include <list>

namespace gridspace::timebox {

/// All packet sockets in a box, and the frames that will come.
class PacketSockets {
  public:
    PacketSockets(PacketLink link, std::int64_t epoch_ns);

    /// `file`: what the kernel has in its place. False: it could not be prepared.
    bool add(UniqueFd const& file, int kind, std::uint16_t protocol);
    [[nodiscard]] PacketSocket* find(UniqueFd const& file); ///< nullptr: it is no packet socket

    void arrives(PacketFrame frame) { coming_.push_back(std::move(frame)); }
    [[nodiscard]] std::optional<std::int64_t> next_ns() const {
        return coming_.empty() ? std::nullopt : std::optional{coming_.front().at_ns};
    }
    /// Hands frames up to now to their sockets.
    void deliver(std::int64_t now_ns);
    /// The oldest frame of the queue has been read, by way of that file.
    void taken(PacketSocket& socket, UniqueFd const& file);
    /// A frame of its own leaves: what is refused, or nothing. Others in the box that see what leaves, see it.
    [[nodiscard]] std::string send(PacketSocket const& from, std::vector<std::uint8_t> frame, std::int64_t now_ns);
    /// A frame of the IP of the box leaves: who sees what leaves, sees it.
    void leaves(std::span<std::uint8_t const> frame, std::int64_t now_ns);
    /// A program gives slots of a ring back without a call: to be looked at before it waits.
    void look_at_rings();

    [[nodiscard]] PacketLink const& link() const { return link_; }
    [[nodiscard]] std::int64_t epoch_ns() const { return epoch_ns_; }

  private:
    void hand(PacketFrame const& frame, PacketSocket const* except);
    [[nodiscard]] bool mark(PacketSocket& socket) const; ///< false: it has been closed

    PacketLink link_;
    std::int64_t epoch_ns_;
    UniqueFd marker_;
    std::list<PacketSocket> sockets_; ///< as they were made
    std::deque<PacketFrame> coming_;
};

} // namespace gridspace::timebox

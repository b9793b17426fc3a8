// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "timebox/message.hpp"
#include "timebox/packet_sockets.hpp"
#include "timebox/simulated_clock.hpp"
#include "timebox/thread.hpp"

#include <functional>

namespace gridspace::timebox {

/// The calls of packet(7), answered without the kernel.
class PacketCalls {
  public:
    /// `refused(what)`: it is not available, and is reported at the end.
    PacketCalls(PacketSockets& sockets, SimulatedClock const& clock, std::function<void(std::string const&)> refused)
        : sockets_{sockets}, clock_{clock}, refused_{std::move(refused)} {}

    /// Each returns what the program gets: a value, or minus an error number. Nothing: the kernel may answer.
    [[nodiscard]] std::int64_t bind(Thread const& t, PacketSocket& socket) const;
    [[nodiscard]] std::int64_t name(Thread const& t, PacketSocket const& socket) const;
    [[nodiscard]] std::optional<std::int64_t> option(Thread const& t, PacketSocket& socket, UniqueFd const& file);
    [[nodiscard]] std::optional<std::int64_t> look_at_option(Thread const& t, PacketSocket& socket) const;
    [[nodiscard]] std::int64_t send(Thread const& t, PacketSocket const& socket);
    /// Something has come.
    [[nodiscard]] std::int64_t receive(Thread const& t, PacketSocket& socket, UniqueFd const& file) const;

  private:
    [[nodiscard]] std::int64_t send_one(Thread const& t, PacketSocket const& socket, Message const& message);
    [[nodiscard]] std::int64_t receive_one(Thread const& t, PacketSocket const& socket, PacketFrame const& frame,
                                           Message const& message, int flags) const;
    [[nodiscard]] std::vector<std::uint8_t> control(PacketSocket const& socket, PacketFrame const& frame) const;
    [[nodiscard]] std::optional<std::int64_t> packet_option(Thread const& t, PacketSocket& socket,
                                                            UniqueFd const& file);
    [[nodiscard]] std::int64_t refuse(std::string const& what, int error) {
        refused_(what);
        return -error;
    }

    PacketSockets& sockets_;
    SimulatedClock const& clock_;
    std::function<void(std::string const&)> refused_;
};

} // namespace gridspace::timebox

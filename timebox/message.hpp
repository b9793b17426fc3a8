// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "timebox/tracee.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <sys/socket.h>
#include <sys/uio.h>
#include <vector>

namespace gridspace::timebox {

/// The memory of a program that a call of send(2), recv(2), read(2) or write(2) and their relatives name.
struct Message {
    std::vector<iovec> parts; ///< addresses of the program
    std::uint64_t name{0}, name_size{0};
    std::uint64_t name_size_at{0}; ///< recvfrom: where the size stands
    std::uint64_t header{0};       ///< address of its msghdr; 0: it has none
    msghdr fields{};               ///< what stands there
    std::uint64_t count_at{0};     ///< of mmsghdr: where its octets are counted
};
/// One, or several of sendmmsg and recvmmsg.
[[nodiscard]] std::vector<Message> messages_of(pid_t tid, Call const& call);
/// Does `one` for each, and counts its octets in the mmsghdr; nothing: there is no more to do. The result of the call:
/// of one message that of `one`, of several how many there were; what went before a failure counts (sendmmsg(2)).
template <class One>
std::int64_t each_message(pid_t tid, Call const& call, One const& one) {
    std::int64_t done = 0;
    for (Message const& message : messages_of(tid, call)) {
        std::optional<std::int64_t> const result = one(message);
        if (!result) {
            break;
        }
        if (message.count_at == 0) {
            return *result;
        }
        if (*result < 0) {
            return done > 0 ? done : *result;
        }
        put(tid, message.count_at, static_cast<std::uint32_t>(*result));
        ++done;
    }
    return done;
}
/// MSG_DONTWAIT and others.
[[nodiscard]] int flags_of(Call const& call);

[[nodiscard]] std::size_t room_of(Message const& message);
/// False: that is not the program's memory.
[[nodiscard]] bool gather(pid_t tid, Message const& message, std::vector<std::uint8_t>& out);
/// As much as there is room for.
[[nodiscard]] bool scatter(pid_t tid, Message const& message, std::span<std::uint8_t const> octets);

} // namespace gridspace::timebox

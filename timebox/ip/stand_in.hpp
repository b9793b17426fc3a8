// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/unique_fd.hpp"

#include <cstdint>
#include <string>

/// Sockets of the family unix (unix(7)) that stand for those of IP and of packets.
namespace gridspace::timebox {

/// That wait in one: the kernel's queue has room for ten.
inline constexpr int kMostMarks = 8;

/// By which a stand-in is recognised, whatever its descriptor is: 0: none, or no socket.
[[nodiscard]] std::uint64_t socket_inode_of(UniqueFd const& file);
/// Binds it to a name that is free; the name, or nothing.
[[nodiscard]] std::string give_address(UniqueFd const& file);
[[nodiscard]] bool connect_to(UniqueFd const& file, std::string const& address);
[[nodiscard]] bool send_to(UniqueFd const& file, std::string const& address); ///< a mark of one octet
/// Somebody has the socket of that name and kind still open.
[[nodiscard]] bool address_is_taken(std::string const& address, bool stream);
/// A connected stream takes nothing more, as one whose connection is being made; until our end is emptied.
void make_unwritable(UniqueFd const& file);
void make_writable(UniqueFd const& ours);

} // namespace gridspace::timebox

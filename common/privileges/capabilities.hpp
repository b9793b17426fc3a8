// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace gridspace {

/// Bits of capabilities(7).
inline constexpr std::uint64_t kMayLimitOthers = std::uint64_t{1} << 8U;      // CAP_SETPCAP: what they may ever gain
inline constexpr std::uint64_t kMayOpenRawSockets = std::uint64_t{1} << 13U;  // CAP_NET_RAW
inline constexpr std::uint64_t kMayTrace = std::uint64_t{1} << 19U;           // CAP_SYS_PTRACE
inline constexpr std::uint64_t kMayEnterNamespaces = std::uint64_t{1} << 21U; // CAP_SYS_ADMIN

/// Gives up every capability but these, for what this thread executes too, and the gain of any by executing a file
/// (no_new_privs). Before other threads start: it counts for the calling one. Needs no privilege, and has no errors:
/// what is not there cannot be kept.
void keep_only_capabilities(std::uint64_t capabilities) noexcept;

/// Whether this thread holds CAP_NET_RAW.
bool may_open_raw_sockets() noexcept;

} // namespace gridspace

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gridspace::bus {

/// What an instance of a keyed topic is known by on the wire (DDS-RTPS 9.6.3.8).
using KeyHash = std::array<std::uint8_t, 16>;

/// The hash of a key in big-endian CDR: the octets themselves when every key of the type fits into them, otherwise
/// their MD5.
[[nodiscard]] KeyHash key_hash(std::span<std::byte const> key, bool always_fits);

} // namespace gridspace::bus

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/octets.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

/// Parallel Redundancy Protocol, IEC 62439-3 clause 4: a doubly attached node sends every frame on two networks and
/// passes on the copy that comes first.
namespace gridspace::prp {

using iec61850::Octets;

inline constexpr std::uint16_t kSuffix = 0x88FB;
inline constexpr std::size_t kTrailerOctets = 6;

enum class Lan : std::uint8_t { a = 0xA, b = 0xB };
inline constexpr std::array kLans{Lan::a, Lan::b};

/// The redundancy control trailer at the end of a frame: sequence number, 4 bits of network, 12 bits of size, suffix.
struct RedundancyTrailer {
    std::uint16_t sequence{0};
    Lan lan{Lan::a};
    friend bool operator==(RedundancyTrailer const&, RedundancyTrailer const&) = default;
};

/// Writes the frame (from the destination address on, without FCS) with its trailer to `out`, padded before the trailer
/// so that no bridge has to pad behind it (60 octets; 64 with a VLAN tag, which a bridge may take off).
void write_with_trailer(Octets frame, RedundancyTrailer const& trailer, std::vector<std::uint8_t>& out);

/// The trailer of a frame; nothing when there is none, or when its size is not that of the frame.
[[nodiscard]] std::optional<RedundancyTrailer> trailer_of(Octets frame) noexcept;

} // namespace gridspace::prp

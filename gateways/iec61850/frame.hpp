// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/decode_error.hpp"
#include "gateways/iec61850/octets.hpp"

#include <array>
#include <compare>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::iec61850 {

inline constexpr std::uint16_t kGooseEthertype = 0x88B8, kSvEthertype = 0x88BA, kVlanEthertype = 0x8100;
/// Octets from APPID to the end: the payload of an Ethernet frame.
inline constexpr std::size_t kMaxLength = 1500;
inline constexpr std::size_t kHeaderOctets = 8; ///< APPID, Length, Reserved1, Reserved2
inline constexpr std::uint16_t kSimulatedBit = 0x8000;

struct Mac {
    std::array<std::uint8_t, 6> octets{};

    [[nodiscard]] bool is_group() const noexcept { return (octets[0] & 1U) != 0; }
    [[nodiscard]] std::string to_string() const; ///< "01:0C:CD:04:00:21"
    /// Six pairs of hexadecimal digits, separated by ':' or '-'; nothing for any other text.
    [[nodiscard]] static std::optional<Mac> parse(std::string_view text);
    friend auto operator<=>(Mac const&, Mac const&) = default;
};

/// The content of a 802.1Q tag.
struct VlanTag {
    std::uint16_t id{0};      ///< 0: a priority tag
    std::uint8_t priority{4}; ///< 0 to 7; 4 is what IEC 61850 recommends
    bool drop_eligible{false};

    [[nodiscard]] std::uint16_t tci() const noexcept {
        return static_cast<std::uint16_t>(unsigned{priority} << 13U | (drop_eligible ? 0x1000U : 0U) | (id & 0xFFFU));
    }
    [[nodiscard]] static VlanTag from_tci(std::uint16_t tci) noexcept {
        return {static_cast<std::uint16_t>(tci & 0xFFFU), static_cast<std::uint8_t>(tci >> 13U), (tci & 0x1000U) != 0};
    }
    friend bool operator==(VlanTag const&, VlanTag const&) = default;
};

/// What stands before the APDU of GOOSE and SV (IEC 61850-8-1 and 9-2, annex C).
struct FrameHeader {
    Mac destination, source;
    std::optional<VlanTag> vlan; ///< the outer one, when there are two
    std::uint16_t ethertype{0}, app_id{0}, reserved1{0}, reserved2{0};
    std::uint16_t length{0}; ///< as it was written: from APPID to the end of the APDU
    std::uint32_t apdu_offset{0};
    Octets apdu{}; ///< from the APDU's tag to the end that Length gives; padding is left out

    [[nodiscard]] bool simulated() const noexcept { return (reserved1 & kSimulatedBit) != 0; }
};

/// Reads addresses, up to two VLAN tags and the eight octets behind the ethertype, which must be GOOSE's or SV's.
[[nodiscard]] Decoded<void> decode_header(Octets frame, FrameHeader& out) noexcept;

/// Octets up to and including the ethertype behind the VLAN tags, two at most; more than the frame has when it is too
/// short.
[[nodiscard]] std::size_t ethernet_header_octets(Octets frame) noexcept;
/// The ethertype behind up to two VLAN tags; 0 when the frame is too short.
[[nodiscard]] std::uint16_t ethertype_of(Octets frame) noexcept;

/// How a stream is addressed on the wire.
struct Address {
    Mac destination, source;
    std::optional<VlanTag> vlan;
    std::uint16_t app_id{0};
    bool simulated{false}; ///< S bit
};

/// Appends addresses, tag and ethertype.
void append_ethernet_header(std::vector<std::uint8_t>& out, Mac const& destination, Mac const& source,
                            std::optional<VlanTag> const& vlan, std::uint16_t ethertype);
/// Appends the header with Length 0, for who fills it in when the APDU stands behind.
void append_header(std::vector<std::uint8_t>& out, Address const& address, std::uint16_t ethertype);
/// Offset of APPID in a frame that append_header() began.
[[nodiscard]] inline std::size_t app_id_offset(Address const& address) noexcept {
    return address.vlan ? 18 : 14;
}

} // namespace gridspace::iec61850

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/decode_error.hpp"
#include "gateways/iec61850/frame.hpp"

#include <array>
#include <vector>

/// GOOSE and sampled values over UDP (R-GOOSE, R-SV): the session protocol of IEC TR 61850-90-5 in the form of
/// IEC 61850-8-1:2011/AMD1:2020, which names a key and no algorithms, behind the header of connectionless transport.
namespace gridspace::iec61850 {

inline constexpr std::uint16_t kRoutablePort = 102;

/// One APDU of a datagram.
struct RoutablePayload {
    bool goose{true};      ///< false: sampled values
    bool simulated{false}; ///< flag of the session, in addition to the one in a GOOSE PDU
    std::uint16_t app_id{0};
    Octets apdu{}; ///< from its tag to its end
};

/// What stands before the payloads.
struct SessionHeader {
    bool goose{true}; ///< session identifier 0xA1; false: 0xA2, sampled values
    std::uint32_t spdu_number{0};
    std::uint16_t version{2};
    std::uint32_t time_of_current_key{0}; ///< seconds of UTC
    std::uint16_t time_to_next_key{0};    ///< minutes
    std::uint32_t key_id{0};              ///< 0: neither signed nor encrypted
    Octets initialisation_vector{};
};

/// A decoded datagram, as views into it.
struct RoutableFrame {
    static constexpr std::size_t kMaxPayloads = 16;
    SessionHeader session;
    std::uint32_t spdu_length{0}; ///< as it was written
    std::array<RoutablePayload, kMaxPayloads> payloads{};
    std::size_t count{0};
    Octets signature{}; ///< not checked

    [[nodiscard]] std::span<RoutablePayload const> view() const noexcept { return {payloads.data(), count}; }
};

/// Reads the payload of a UDP datagram. Tolerant: with or without the transport header and the signature. Allocates
/// nothing. Encrypted payloads are `bad_tag`: what they hold cannot be told.
[[nodiscard]] Decoded<void> decode_routable(Octets datagram, RoutableFrame& out) noexcept;

/// Appends the payload of a UDP datagram, without a signature.
void append_routable(SessionHeader const& session, std::span<RoutablePayload const> payloads,
                     std::vector<std::uint8_t>& out);
[[nodiscard]] std::vector<std::uint8_t> encode_routable(SessionHeader const& session,
                                                        std::span<RoutablePayload const> payloads);

/// Octets of a datagram of one message without its APDU: IPv4, UDP, transport and session header, payload header.
inline constexpr std::size_t kRoutableOverhead = 20 + 8 + 2 + 25 + 4 + 6;

using Ipv4 = std::array<std::uint8_t, 4>;

/// Where a datagram is from and goes.
struct RoutableAddress {
    Mac destination, source;
    Ipv4 ip_destination{}, ip_source{};
    std::uint8_t ttl{16}, dscp{46};
    std::optional<VlanTag> vlan{};
    /// The Ethernet address of the group `ip_destination` (RFC 1112).
    [[nodiscard]] Mac group() const noexcept;
};

/// Appends the headers of Ethernet, IPv4 and UDP; complete_udp_frame() writes their lengths and checksums when the
/// datagram stands behind.
void append_udp_header(RoutableAddress const& address, std::vector<std::uint8_t>& out);
void complete_udp_frame(std::span<std::uint8_t> frame);
/// The whole frame.
[[nodiscard]] std::vector<std::uint8_t> udp_frame(RoutableAddress const& address, Octets datagram);

/// The payload of a frame that is UDP over IPv4 to port 102; empty for every other frame, and for fragments.
[[nodiscard]] Octets routable_payload(Octets frame) noexcept;

/// The ethertype of the messages in a frame: its own, or that of GOOSE or SV when it is such a session over UDP.
[[nodiscard]] std::uint16_t stream_ethertype(Octets frame) noexcept;

/// The same message as it would stand in an Ethernet frame of its own (0x88B8, 0x88BA), for who reads those.
void as_ethernet(Mac const& destination, Mac const& source, RoutablePayload const& payload,
                 std::vector<std::uint8_t>& out);
/// With the addresses of `frame`, in which it came.
void as_ethernet(Octets frame, RoutablePayload const& payload, std::vector<std::uint8_t>& out);
[[nodiscard]] inline std::vector<std::uint8_t> as_ethernet(Mac const& destination, Mac const& source,
                                                           RoutablePayload const& payload) {
    std::vector<std::uint8_t> out;
    as_ethernet(destination, source, payload, out);
    return out;
}

} // namespace gridspace::iec61850

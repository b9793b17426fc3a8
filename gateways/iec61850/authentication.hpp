// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/authentication_key.hpp"
#include "gateways/iec61850/frame.hpp"

#include <string_view>

namespace gridspace::iec61850 {

/// What stands behind the APDU of an authenticated frame, in the style of IEC 62351-6:2020: an element 0x85 with
/// version (1 octet), time of the current key (4), minutes to the next key (2), initialisation vector (12), key id (4)
/// and the code. Its length is in the low twelve bits of Reserved1; Length goes on counting the APDU alone, so who does
/// not know it reads the frame as before. The code covers everything from the ethertype behind the VLAN tags to the
/// octet before the code.
inline constexpr std::size_t kAuthenticationFields = 23; ///< of the element's value, before the code
inline constexpr std::uint16_t kExtensionLengthBits = 0x0FFF;

/// Octets that a frame grows by.
[[nodiscard]] std::size_t extension_octets(CodeAlgorithm algorithm) noexcept;

/// Appends codes to the frames of one sender. The initialisation vector is the last four octets of the source address
/// and a counter: the microsecond of UTC, and always more than the one before. Not thread-safe.
class FrameSigner {
  public:
    explicit FrameSigner(CodeAlgorithm algorithm) : algorithm_{algorithm} {}

    /// The frame with its extension, in memory that is valid until the next call; nothing when no key is valid at
    /// `utc_ns`, when the frame would be longer than Ethernet allows, or when it is none of SV or GOOSE. `counter`: the
    /// sender's, over all of its streams.
    [[nodiscard]] Octets sign(Octets frame, KeyRing& keys, std::int64_t utc_ns, std::uint64_t& counter);

  private:
    CodeAlgorithm algorithm_;
    std::vector<std::uint8_t> out_;
};

/// What the receiver of a frame finds.
enum class Authenticity : std::uint8_t {
    genuine,
    untagged,    ///< no extension
    malformed,   ///< an extension that is not what this page says, or a code of another length
    unknown_key, ///< no key of this id
    invalid_key, ///< a key whose time has not come, or is over
    wrong_code,  ///< altered, or made without the key
    replayed,    ///< genuine, and it was there already, or is older than the window
    out_of_time, ///< genuine, and sent too long ago, or in the future
};
inline constexpr std::size_t kAuthenticities = 8;
[[nodiscard]] std::string_view authenticity_name(Authenticity a) noexcept;

/// Judges the frames of one stream. Not thread-safe.
class FrameVerifier {
  public:
    /// `max_age_ns`: farthest that the counter of a frame may be from the receiver's UTC; 0: not judged.
    FrameVerifier(CodeAlgorithm algorithm, std::int64_t max_age_ns) : algorithm_{algorithm}, max_age_ns_{max_age_ns} {}

    [[nodiscard]] Authenticity judge(Octets frame, KeyRing& keys, std::int64_t utc_ns);

  private:
    /// The newest frames of one sender.
    struct Sender {
        std::uint32_t name{0};
        std::uint64_t newest{0}, forgotten{0}; ///< the highest that is no longer in `seen`
        std::array<std::uint64_t, 64> seen{};
        std::size_t next{0};
    };
    [[nodiscard]] bool is_new(std::uint32_t sender, std::uint64_t counter);

    CodeAlgorithm algorithm_;
    std::int64_t max_age_ns_;
    std::vector<Sender> senders_;
};

} // namespace gridspace::iec61850

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

namespace gridspace::iec61850 {

/// Why a frame cannot be read.
enum class Reason : std::uint8_t {
    none,
    too_short,        ///< ends before the header of the frame does
    other_ethertype,  ///< neither 0x88B8 nor 0x88BA, or not the one that was asked for
    bad_frame_length, ///< the Length field is below 8 or beyond the end of the frame
    truncated,        ///< an element is longer than what contains it
    bad_length_form,  ///< indefinite, reserved or longer than four octets
    bad_tag,          ///< another element was expected, or a tag number of more than four octets
    missing_field,    ///< a mandatory element is absent
    duplicate_field,  ///< an element occurs twice
    bad_value,        ///< a value of impossible length or range
    too_deep,         ///< structures and arrays nested deeper than kMaxDepth
    count_mismatch,   ///< noASDU is not the number of ASDUs
    too_many,         ///< more ASDUs than an Ethernet frame can hold
};
inline constexpr std::size_t kReasons = 13;

/// A frame that cannot be read: the reason, where (octets from the start of the frame as it was given), and the tag of
/// the element concerned (0: none). Eight octets without a gap: an error travels in a register, and whether there is
/// one in another.
struct DecodeError {
    std::uint32_t offset{0};
    Reason reason{Reason::none};
    std::uint8_t tag{0};
    friend bool operator==(DecodeError const&, DecodeError const&) = default;
};

template <class T>
using Decoded = std::expected<T, DecodeError>;

[[nodiscard]] inline std::unexpected<DecodeError> undecodable(Reason reason, std::size_t offset,
                                                              std::uint32_t tag = 0) noexcept {
    return std::unexpected{DecodeError{static_cast<std::uint32_t>(offset), reason, static_cast<std::uint8_t>(tag)}};
}

/// "truncated", for statistics.
[[nodiscard]] std::string_view reason_name(Reason reason) noexcept;
/// "element 0x82 at octet 31 is longer than what contains it", for people.
[[nodiscard]] std::string describe(DecodeError const& error);

/// How many frames could not be read, by reason.
struct DecodeCounters {
    std::array<std::uint64_t, kReasons> by_reason{};
    void count(Reason reason) noexcept { ++by_reason[static_cast<std::size_t>(reason)]; }
    [[nodiscard]] std::uint64_t total() const noexcept {
        std::uint64_t sum = 0;
        for (std::uint64_t const n : by_reason) {
            sum += n;
        }
        return sum;
    }
};

} // namespace gridspace::iec61850

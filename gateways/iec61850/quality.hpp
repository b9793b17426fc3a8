// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace gridspace::iec61850 {

/// Quality of IEC 61850-7-3, bit n of the standard as 1 << n: so it is in a sampled value, and reversed in a GOOSE bit
/// string.
namespace quality {
inline constexpr std::uint32_t kGood = 0, kInvalid = 0x2, kReserved = 0x1, kQuestionable = 0x3, kValidity = 0x3;
inline constexpr std::uint32_t kOverflow = 1U << 2, kOutOfRange = 1U << 3, kBadReference = 1U << 4,
                               kOscillatory = 1U << 5, kFailure = 1U << 6, kOldData = 1U << 7, kInconsistent = 1U << 8,
                               kInaccurate = 1U << 9, kSubstituted = 1U << 10, kTest = 1U << 11,
                               kOperatorBlocked = 1U << 12;
inline constexpr std::uint32_t kDerived = 1U << 13; ///< 9-2LE only
inline constexpr unsigned kBits = 13;               ///< of the standard: what GOOSE carries
inline constexpr unsigned kSampledBits = 14;        ///< of sampled values: with kDerived

/// Only validity "good" is good: older and newer documents disagree about the two bits of "invalid".
[[nodiscard]] constexpr bool is_good(std::uint32_t q) noexcept {
    return (q & kValidity) == kGood;
}

/// What a value is worth: the worse of its validity and of what its details ask for. By IEC 61850-7-3, 6.2, overflow
/// and failure make it invalid, and every other detail at least questionable, whatever the validity itself is; a
/// value that an operator has blocked is an old one. Where it comes from (substituted, derived) and test say nothing
/// here.
enum class Worth : std::uint8_t { good, questionable, invalid };
[[nodiscard]] constexpr Worth worth(std::uint32_t q) noexcept {
    constexpr std::uint32_t kDoubts =
        kOutOfRange | kBadReference | kOscillatory | kOldData | kInconsistent | kInaccurate | kOperatorBlocked;
    if ((q & (kOverflow | kFailure)) != 0 || (!is_good(q) && (q & kValidity) != kQuestionable)) {
        return Worth::invalid;
    }
    return is_good(q) && (q & kDoubts) == 0 ? Worth::good : Worth::questionable;
}
} // namespace quality

/// Double-point position (Dbpos).
enum class Position : std::uint8_t { intermediate = 0, open = 1, closed = 2, bad = 3 };

} // namespace gridspace::iec61850

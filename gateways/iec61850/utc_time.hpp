// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace gridspace::iec61850 {

/// UtcTime of IEC 61850-8-1: seconds since 1970, a fraction of 24 bits and the quality of the clock.
struct UtcTime {
    static constexpr std::uint8_t kLeapSecondsKnown = 0x80, kClockFailure = 0x40, kNotSynchronised = 0x20;
    static constexpr std::uint8_t kAccuracyUnspecified = 0x1F;

    std::uint32_t seconds{0};
    std::uint32_t fraction{0}; ///< of a second, in 2^-24 s
    std::uint8_t quality{0};   ///< flags above; the low five bits are the accuracy in bits of the fraction

    friend bool operator==(UtcTime const&, UtcTime const&) = default;

    /// From nanoseconds since 1970 (>= 0); the fraction is rounded to nearest, carrying into the seconds.
    [[nodiscard]] static constexpr UtcTime from_nanoseconds(std::int64_t ns, std::uint8_t quality = 0) noexcept {
        std::uint64_t const whole = static_cast<std::uint64_t>(ns) / 1'000'000'000U;
        std::uint64_t const rest = static_cast<std::uint64_t>(ns) % 1'000'000'000U;
        std::uint64_t const fraction = ((rest << 24U) + 500'000'000U) / 1'000'000'000U;
        return {static_cast<std::uint32_t>(whole + (fraction >> 24U)), static_cast<std::uint32_t>(fraction & 0xFFFFFFU),
                quality};
    }
    [[nodiscard]] constexpr std::int64_t nanoseconds() const noexcept {
        return std::int64_t{seconds} * 1'000'000'000 +
               static_cast<std::int64_t>(((std::uint64_t{fraction} * 1'000'000'000U) + (1U << 23U)) >> 24U);
    }
    /// As the eight octets on the wire, read as one big-endian number.
    [[nodiscard]] constexpr std::uint64_t bits() const noexcept {
        return std::uint64_t{seconds} << 32U | std::uint64_t{fraction & 0xFFFFFFU} << 8U | quality;
    }
    [[nodiscard]] static constexpr UtcTime from_bits(std::uint64_t bits) noexcept {
        return {static_cast<std::uint32_t>(bits >> 32U), static_cast<std::uint32_t>(bits >> 8U & 0xFFFFFFU),
                static_cast<std::uint8_t>(bits)};
    }
};

} // namespace gridspace::iec61850

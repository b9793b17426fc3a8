// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/octets.hpp"
#include "gateways/iec61850/utc_time.hpp"

#include <bit>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::iec61850 {

/// The basic types of IEC 61850-7-2 that a data set may hold.
enum class BasicType : std::uint8_t {
    boolean,
    int8,
    int16,
    int32,
    int64,
    uint8,
    uint16,
    uint32,
    uint64,
    float32,
    float64,
    enumerated, ///< an integer
    position,   ///< Dbpos, a coded enumeration of two bits
    bit_string, ///< up to 64 bits; bit 0 is the first on the wire
    quality,    ///< 13 bits, see quality.hpp
    timestamp,  ///< UtcTime
    entry_time, ///< six octets: milliseconds of the day, days since 1984
    visible_string,
    octet_string,
};
inline constexpr std::size_t kBasicTypes = 19;

[[nodiscard]] std::string_view type_name(BasicType type) noexcept; ///< "float32", as in configuration
[[nodiscard]] std::optional<BasicType> parse_type(std::string_view name);
[[nodiscard]] std::vector<std::string> type_names();

[[nodiscard]] constexpr bool is_signed(BasicType t) noexcept {
    return (t >= BasicType::int8 && t <= BasicType::int64) || t == BasicType::enumerated;
}
[[nodiscard]] constexpr bool is_unsigned(BasicType t) noexcept {
    return t >= BasicType::uint8 && t <= BasicType::uint64;
}
[[nodiscard]] constexpr bool is_integer(BasicType t) noexcept {
    return is_signed(t) || is_unsigned(t);
}
[[nodiscard]] constexpr bool is_float(BasicType t) noexcept {
    return t == BasicType::float32 || t == BasicType::float64;
}
[[nodiscard]] constexpr bool is_number(BasicType t) noexcept {
    return is_integer(t) || is_float(t);
}
[[nodiscard]] constexpr bool is_string(BasicType t) noexcept {
    return t == BasicType::visible_string || t == BasicType::octet_string;
}

/// Octets of an integer type; 4 for enumerated.
[[nodiscard]] std::size_t integer_octets(BasicType type) noexcept;

/// A value of a basic type. Strings are views of what they were read from.
struct Value {
    BasicType type{BasicType::boolean};
    std::uint8_t bit_count{0}; ///< of a bit string
    std::uint64_t bits{0};     ///< integers in two's complement, floats in IEEE 754 of their width, UtcTime::bits()
    Octets text{};             ///< of strings

    [[nodiscard]] static Value of(bool v) noexcept { return {BasicType::boolean, 0, v ? 1U : 0U, {}}; }
    [[nodiscard]] static Value of(float v) noexcept {
        return {BasicType::float32, 0, std::bit_cast<std::uint32_t>(v), {}};
    }
    [[nodiscard]] static Value of(double v) noexcept {
        return {BasicType::float64, 0, std::bit_cast<std::uint64_t>(v), {}};
    }
    [[nodiscard]] static Value of(UtcTime v) noexcept { return {BasicType::timestamp, 0, v.bits(), {}}; }
    [[nodiscard]] static Value integer(BasicType type, std::int64_t v) noexcept {
        return {type, 0, static_cast<std::uint64_t>(v), {}};
    }
    [[nodiscard]] static Value quality(std::uint32_t v) noexcept { return {BasicType::quality, 0, v, {}}; }
    [[nodiscard]] static Value visible(std::string_view v) noexcept {
        return {BasicType::visible_string, 0, 0, octets_of(v)};
    }
    /// The number nearest to `v` in a numeric or boolean type; saturates, and NaN becomes 0 in an integer.
    [[nodiscard]] static Value from_number(BasicType type, double v) noexcept;

    [[nodiscard]] bool boolean() const noexcept { return bits != 0; }
    [[nodiscard]] std::int64_t as_signed() const noexcept { return static_cast<std::int64_t>(bits); }
    [[nodiscard]] float as_float() const noexcept { return std::bit_cast<float>(static_cast<std::uint32_t>(bits)); }
    /// Integers, floats, booleans and positions as a number; 0 for the others.
    [[nodiscard]] double number() const noexcept;
    [[nodiscard]] UtcTime time() const noexcept { return UtcTime::from_bits(bits); }

    /// Same type and content.
    friend bool operator==(Value const& a, Value const& b) noexcept;
};

/// "true", "-129", "0x800", "'ab'": for people and JSON-like output.
[[nodiscard]] std::string to_string(Value const& value);

} // namespace gridspace::iec61850

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/basic_type.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::iec61850 {
namespace {

constexpr std::array<std::string_view, kBasicTypes> kBasicTypeNames{
    "boolean", "int8",      "int16",      "int32",          "int64",       "uint8",    "uint16",
    "uint32",  "uint64",    "float32",    "float64",        "enumerated",  "position", "bit_string",
    "quality", "timestamp", "entry_time", "visible_string", "octet_string"};

/// The nearest integer to v within [low, high]; doubles beyond are caught before the conversion is undefined.
template <class T>
T saturate(double v, T low, T high) noexcept {
    if (std::isnan(v)) {
        return 0;
    }
    double const rounded = std::nearbyint(v);
    if (rounded <= static_cast<double>(low)) {
        return low;
    }
    return rounded >= static_cast<double>(high) ? high : static_cast<T>(rounded);
}

} // namespace

std::string_view type_name(BasicType type) noexcept {
    return kBasicTypeNames[static_cast<std::size_t>(type)];
}

std::optional<BasicType> parse_type(std::string_view name) {
    auto const found = std::find(kBasicTypeNames.begin(), kBasicTypeNames.end(), name);
    if (found == kBasicTypeNames.end()) {
        return std::nullopt;
    }
    return static_cast<BasicType>(found - kBasicTypeNames.begin());
}

std::vector<std::string> type_names() {
    return {kBasicTypeNames.begin(), kBasicTypeNames.end()};
}

std::size_t integer_octets(BasicType type) noexcept {
    switch (type) {
    case BasicType::int8:
    case BasicType::uint8:
        return 1;
    case BasicType::int16:
    case BasicType::uint16:
        return 2;
    case BasicType::int64:
    case BasicType::uint64:
        return 8;
    default:
        return 4;
    }
}

Value Value::from_number(BasicType type, double v) noexcept {
    if (type == BasicType::float32) {
        return of(static_cast<float>(v));
    }
    if (type == BasicType::float64) {
        return of(v);
    }
    if (type == BasicType::boolean) {
        return of(v != 0);
    }
    unsigned const width = static_cast<unsigned>(8 * integer_octets(type));
    if (is_unsigned(type)) {
        std::uint64_t const high = ~std::uint64_t{0} >> (64 - width);
        return {type, 0, saturate<std::uint64_t>(v, 0, high), {}};
    }
    std::int64_t const high = static_cast<std::int64_t>(~std::uint64_t{0} >> (65 - width));
    return integer(type, saturate<std::int64_t>(v, -high - 1, high));
}

double Value::number() const noexcept {
    switch (type) {
    case BasicType::float32:
        return as_float();
    case BasicType::float64:
        return std::bit_cast<double>(bits);
    case BasicType::boolean:
    case BasicType::position:
        return static_cast<double>(bits);
    default:
        return is_signed(type) ? static_cast<double>(as_signed()) : is_unsigned(type) ? static_cast<double>(bits) : 0.0;
    }
}

bool operator==(Value const& a, Value const& b) noexcept {
    return a.type == b.type && a.bits == b.bits && a.bit_count == b.bit_count && std::ranges::equal(a.text, b.text);
}

std::string to_string(Value const& value) {
    switch (value.type) {
    case BasicType::boolean:
        return value.boolean() ? "true" : "false";
    case BasicType::float32:
        return fmt::format("{}", value.as_float());
    case BasicType::float64:
        return fmt::format("{}", std::bit_cast<double>(value.bits));
    case BasicType::position: {
        constexpr std::array<std::string_view, 4> kPositions{"intermediate", "open", "closed", "bad"};
        return std::string{kPositions[value.bits & 3U]};
    }
    case BasicType::quality:
        return fmt::format("0x{:04X}", value.bits);
    case BasicType::bit_string: {
        std::string out;
        for (unsigned i = 0; i < value.bit_count; ++i) {
            out.push_back((value.bits >> i & 1U) != 0 ? '1' : '0');
        }
        return out;
    }
    case BasicType::timestamp:
        return fmt::format("{}.{:09}", value.time().nanoseconds() / 1'000'000'000,
                           value.time().nanoseconds() % 1'000'000'000);
    case BasicType::entry_time:
        return fmt::format("{}", value.bits);
    case BasicType::visible_string: {
        std::string out;
        for (std::uint8_t const c : value.text) { // it came from a wire: nothing that moves a cursor
            out += c >= 0x20 && c < 0x7F ? std::string(1, static_cast<char>(c)) : fmt::format("\\x{:02x}", c);
        }
        return out;
    }
    case BasicType::octet_string: {
        std::string out;
        for (std::uint8_t const octet : value.text) {
            out += fmt::format("{:02x}", octet);
        }
        return out;
    }
    default:
        return is_unsigned(value.type) ? fmt::format("{}", value.bits) : fmt::format("{}", value.as_signed());
    }
}

} // namespace gridspace::iec61850

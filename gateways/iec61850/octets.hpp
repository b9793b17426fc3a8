// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

namespace gridspace::iec61850 {

/// Octets of a frame that somebody else owns.
using Octets = std::span<std::uint8_t const>;

/// Reads an unsigned integer of sizeof(T) octets, most significant first. The caller has checked that they are there.
template <class T>
[[nodiscard]] inline T load_be(std::uint8_t const* from) noexcept {
    T value;
    std::memcpy(&value, from, sizeof value);
    if constexpr (sizeof(T) > 1 && std::endian::native == std::endian::little) {
        value = std::byteswap(value);
    }
    return value;
}

template <class T>
inline void store_be(std::uint8_t* to, T value) noexcept {
    if constexpr (sizeof(T) > 1 && std::endian::native == std::endian::little) {
        value = std::byteswap(value);
    }
    std::memcpy(to, &value, sizeof value);
}

/// Appends an unsigned integer of sizeof(T) octets, most significant first.
template <class T>
inline void append_be(std::vector<std::uint8_t>& out, T value) {
    out.resize(out.size() + sizeof(T));
    store_be(out.data() + out.size() - sizeof(T), value);
}
inline void append(std::vector<std::uint8_t>& out, Octets octets) {
    out.insert(out.end(), octets.begin(), octets.end());
}

/// An unsigned integer of 1 to 8 octets, most significant first.
[[nodiscard]] inline std::uint64_t load_be(Octets octets) noexcept {
    std::uint64_t value = 0;
    for (std::uint8_t const octet : octets) {
        value = value << 8 | octet;
    }
    return value;
}

[[nodiscard]] inline std::string_view text_of(Octets octets) noexcept {
    return {reinterpret_cast<char const*>(octets.data()), octets.size()};
}

[[nodiscard]] inline Octets octets_of(std::string_view text) noexcept {
    return {reinterpret_cast<std::uint8_t const*>(text.data()), text.size()};
}

} // namespace gridspace::iec61850

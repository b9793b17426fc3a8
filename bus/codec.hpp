// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace gridspace::bus {

/// What the bus needs to know of a data type: its name on the wire and how samples become CDR and back.
/// A codec without functions (`encode == nullptr`) carries samples as ready CDR bytes: recorder, replay, mapping.
struct Codec {
    std::string_view type_name;
    bool keyed{false};
    std::uint32_t max_size{0}; ///< octets with the encapsulation header; 0: unbounded, payloads grow as needed

    /// Writes the sample with its 4-octet encapsulation header. Returns the octets used, 0 when `out` is too small.
    std::size_t (*encode)(void const* sample, std::span<std::byte> out){nullptr};
    bool (*decode)(std::span<std::byte const> in, void* sample){nullptr}; ///< false: not this type
    std::size_t (*encoded_size)(void const* sample){nullptr};
    void (*key)(void const* sample, std::array<std::uint8_t, 16>& key_hash){nullptr};
};

/// The codec of a type of ours by its name; nullptr for a type that the program was not compiled for.
[[nodiscard]] Codec const* find_codec(std::string_view type_name);

/// The codec of a generated type: of every topic type in idl/ (cmake/GridspaceIdl.cmake).
template <class T>
[[nodiscard]] Codec const& codec_of();

} // namespace gridspace::bus

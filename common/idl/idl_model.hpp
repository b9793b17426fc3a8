// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Data types that a program was not compiled for: read from IDL text, used to decode CDR.
namespace gridspace::idl {

enum class Kind : std::uint8_t {
    boolean,
    octet, ///< octet, uint8
    character,
    int8,
    int16,
    uint16,
    int32,
    uint32,
    int64,
    uint64,
    float32,
    float64,
    string,
    sequence,
    array,
    structure,
    enumeration,
    unsupported, ///< a union, a map, ...: nothing that has one can be decoded
};

/// A type. Composite types refer to others by index in Model::types.
struct Type {
    Kind kind{Kind::boolean};
    std::string name;       ///< of a struct or enum, with its modules ("a::b::Name")
    std::uint32_t bound{0}; ///< of a string or sequence (0: none); length of an array
    std::size_t element{0}; ///< of a sequence or array
    struct Member {
        std::string name;
        std::size_t type{0};
        bool key{false};
    };
    std::vector<Member> members;                              ///< of a struct, inherited ones first
    std::vector<std::pair<std::string, std::int32_t>> values; ///< of an enum
    std::size_t octets{4};                                    ///< of an enum
    std::string unsupported; ///< why samples of it, or with it, cannot be decoded; empty: they can
};

struct Model {
    std::vector<Type> types;
    [[nodiscard]] std::optional<std::size_t>
    find(std::string_view name) const; ///< a struct, enum or unsupported type by its name
    [[nodiscard]] bool is_keyed(std::size_t type) const;
};

/// What becomes of unions, maps, wide characters, bit masks and bit sets, and of preprocessor lines.
enum class Unsupported : std::uint8_t {
    refused, ///< with a line number
    kept, ///< as types that cannot be decoded; of preprocessor lines `#define NAME NUMBER` is taken, others are skipped
};

/// Reads IDL 4.2 as far as data types need it: modules, structs with inheritance and annotations, enums, constants,
/// typedefs, arrays, bounded and unbounded strings and sequences, comments. A struct that is @mutable or has @optional
/// members is read, but cannot be decoded.
[[nodiscard]] Result<Model> parse(std::string_view text, Unsupported unsupported = Unsupported::refused);

} // namespace gridspace::idl

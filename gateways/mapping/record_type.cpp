// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/mapping/record_type.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::mapping {
namespace {

constexpr int kDeepest = 32;
constexpr std::uint64_t kUnbounded = UINT64_MAX;
constexpr std::uint64_t kLargestPayload = 65'536; // more is allocated when it is needed, not reserved

std::uint64_t sum(std::uint64_t a, std::uint64_t b) {
    return a == kUnbounded || b == kUnbounded ? kUnbounded : std::min(a + b, kUnbounded - 1);
}
std::uint64_t product(std::uint64_t a, std::uint64_t b) {
    return a == kUnbounded || (a != 0 && b > (kUnbounded - 1) / a) ? kUnbounded : a * b;
}

} // namespace

BasicType basic_type(idl::Kind kind) noexcept {
    switch (kind) {
    case idl::Kind::boolean:
        return BasicType::boolean;
    case idl::Kind::octet:
    case idl::Kind::character:
        return BasicType::uint8;
    case idl::Kind::int8:
        return BasicType::int8;
    case idl::Kind::int16:
        return BasicType::int16;
    case idl::Kind::uint16:
        return BasicType::uint16;
    case idl::Kind::int32:
        return BasicType::int32;
    case idl::Kind::uint32:
        return BasicType::uint32;
    case idl::Kind::int64:
        return BasicType::int64;
    case idl::Kind::uint64:
        return BasicType::uint64;
    case idl::Kind::float32:
        return BasicType::float32;
    case idl::Kind::float64:
        return BasicType::float64;
    case idl::Kind::enumeration:
        return BasicType::enumerated;
    default:
        return BasicType::visible_string;
    }
}

std::uint32_t cdr_octets(idl::Kind kind) noexcept {
    switch (kind) {
    case idl::Kind::boolean:
    case idl::Kind::octet:
    case idl::Kind::character:
    case idl::Kind::int8:
        return 1;
    case idl::Kind::int16:
    case idl::Kind::uint16:
        return 2;
    case idl::Kind::int64:
    case idl::Kind::uint64:
    case idl::Kind::float64:
        return 8;
    default:
        return 4;
    }
}

struct RecordType::Builder {
    idl::Model const& model;
    std::string_view each;
    RecordType& out;
    std::string problem{};
    bool each_found{false};

    /// Adds the fields of a type; its place in the tree. `octets`: its largest size, padding included.
    Node build(std::size_t index, std::string const& path, int depth, bool below_each, bool key,
               std::uint64_t& octets) {
        Node node;
        node.first_field = static_cast<std::uint32_t>(out.fields_.size());
        node.is_key = key;
        if (!problem.empty()) {
            return node;
        }
        if (depth > kDeepest) {
            problem = fmt::format("it is nested more than {} deep, or contains itself, at '{}'", kDeepest, path);
            return node;
        }
        idl::Type const& type = model.types[index];
        switch (type.kind) {
        case idl::Kind::structure:
            node.shape = Shape::structure;
            octets = 0;
            for (idl::Type::Member const& member : type.members) {
                std::uint64_t part = 0;
                // Without a key of its own a struct that is a key is one as a whole.
                bool const is_key = depth == 0 ? member.key : key && (!model.is_keyed(index) || member.key);
                node.children.push_back(build(member.type, path.empty() ? member.name : path + "." + member.name,
                                              depth + 1, below_each, is_key, part));
                octets = sum(octets, part);
            }
            break;
        case idl::Kind::sequence:
        case idl::Kind::array:
            elements(node, type, path, depth, below_each, key, octets);
            break;
        default:
            leaf(node, type, path, octets);
        }
        return node;
    }

    void elements(Node& node, idl::Type const& type, std::string const& path, int depth, bool below_each, bool key,
                  std::uint64_t& octets) {
        bool const is_array = type.kind == idl::Kind::array;
        node.shape = is_array ? Shape::array : Shape::sequence;
        node.bound = type.bound;
        node.is_each = !each.empty() && path == each && depth == 1 && !is_array;
        node.slots = node.is_each      ? 1
                     : is_array        ? type.bound
                     : type.bound == 0 ? kElements
                                       : std::min(type.bound, kElements);
        if (node.is_each) {
            each_found = true;
            out.each_first_ = node.first_field;
            out.each_bound_ = type.bound;
        }
        std::uint64_t element = 0;
        for (std::uint32_t i = 0; i < node.slots && problem.empty(); ++i) {
            std::uint64_t part = 0;
            Node child = build(type.element, node.is_each ? path : fmt::format("{}.{}", path, i), depth + 1,
                               below_each || node.is_each, key, part);
            element = std::max(element, part);
            if (i == 0) {
                node.children.push_back(std::move(child));
                node.stride = static_cast<std::uint32_t>(out.fields_.size()) - node.first_field;
            }
        }
        if (node.is_each) {
            out.each_count_ = node.stride;
        }
        octets = is_array ? product(element, type.bound)
                          : sum(7, type.bound == 0 ? kUnbounded : product(element, type.bound));
    }

    void leaf(Node& node, idl::Type const& type, std::string const& path, std::uint64_t& octets) {
        node.kind = type.kind;
        node.bound = type.bound;
        Field field{path, basic_type(type.kind), 0, {}};
        octets = 2 * cdr_octets(type.kind) - 1; // with the most padding
        if (type.kind == idl::Kind::string) {
            field.length = type.bound == 0
                               ? kTextOctets
                               : static_cast<std::uint16_t>(std::min<std::uint32_t>(type.bound, kTextOctets));
            octets = type.bound == 0 ? kUnbounded : sum(8, type.bound);
        }
        std::uint32_t enumeration = kNone;
        if (type.kind == idl::Kind::enumeration) {
            auto const known = std::find(out.enums_.begin(), out.enums_.end(), type.values);
            enumeration = static_cast<std::uint32_t>(known - out.enums_.begin());
            if (known == out.enums_.end()) {
                out.enums_.push_back(type.values);
            }
        }
        out.fields_.push_back(std::move(field));
        out.enum_of_.push_back(enumeration);
        if (out.fields_.size() > kMaxFields) {
            problem = fmt::format("it has more than {} fields", kMaxFields);
        }
    }
};

Result<RecordType> RecordType::create(idl::Model const& model, std::string_view type, std::string_view each) {
    auto const index = model.find(type);
    if (!index || model.types[*index].kind != idl::Kind::structure) {
        std::vector<std::string> names;
        for (idl::Type const& known : model.types) {
            if (known.kind == idl::Kind::structure) {
                names.push_back(known.name);
            }
        }
        return fail(ExitCode::usage, fmt::format("there is no struct '{}'", type), spelling_hint(type, names));
    }
    RecordType out;
    out.name_ = type;
    out.keyed_ = model.is_keyed(*index);
    Builder builder{model, each, out};
    std::uint64_t octets = 0;
    out.root_ = builder.build(*index, "", 0, false, false, octets);
    if (!builder.problem.empty()) {
        return fail(ExitCode::usage, fmt::format("the type '{}' cannot be mapped: {}", type, builder.problem));
    }
    if (!each.empty() && !builder.each_found) {
        return fail(ExitCode::usage, fmt::format("'{}' is not a sequence of the type '{}'", each, type),
                    "a sequence at its top level");
    }
    octets = sum(octets, 4);
    out.max_octets_ = octets > kLargestPayload ? 0 : static_cast<std::uint32_t>(octets);
    return out;
}

std::optional<std::size_t> RecordType::index_of(std::string_view field) const noexcept {
    auto const found = std::find_if(fields_.begin(), fields_.end(), [&](Field const& f) { return f.name == field; });
    return found == fields_.end() ? std::nullopt : std::optional{static_cast<std::size_t>(found - fields_.begin())};
}

std::vector<std::pair<std::string, std::int32_t>> const& RecordType::enumerators(std::size_t field) const {
    static std::vector<std::pair<std::string, std::int32_t>> const kNoNames;
    return enum_of_[field] == kNone ? kNoNames : enums_[enum_of_[field]];
}

} // namespace gridspace::mapping

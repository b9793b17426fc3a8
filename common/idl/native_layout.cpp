// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/idl/native_layout.hpp"

#include "common/idl/aligned.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace gridspace::idl {
namespace {

constexpr int kMaxLayoutDepth = 32;
constexpr std::size_t kMaxOctets = std::size_t{1} << 26U; ///< of a struct: arrays of arrays grow quickly

std::size_t octets_of(Kind kind) {
    switch (kind) {
    case Kind::boolean:
    case Kind::octet:
    case Kind::character:
    case Kind::int8:
        return 1;
    case Kind::int16:
    case Kind::uint16:
        return 2;
    case Kind::int32:
    case Kind::uint32:
    case Kind::float32:
    case Kind::enumeration:
        return 4;
    case Kind::int64:
    case Kind::uint64:
    case Kind::float64:
        return 8;
    default:
        return 0;
    }
}

std::string_view name_of(Kind kind) {
    static constexpr std::array<std::string_view, 18> kNames{
        "boolean", "octet", "char",   "int8",   "int16",    "uint16", "int32",  "uint32", "int64",
        "uint64",  "float", "double", "string", "sequence", "array",  "struct", "enum",   "unsupported"};
    return kNames.at(static_cast<std::size_t>(kind));
}

std::string json_of(NativeLayout const& layout, std::size_t index) {
    Type const& type = layout.model().types[index];
    NativeLayout::Place const& place = layout.place(index);
    std::string out = fmt::format(R"({{"kind":"{}","size":{})", name_of(type.kind), place.size);
    if (type.kind == Kind::string || type.kind == Kind::sequence || type.kind == Kind::array) {
        out += fmt::format(R"(,"bound":{})", type.bound);
    }
    if (type.kind == Kind::sequence || type.kind == Kind::array) {
        out += R"(,"element":)" + json_of(layout, type.element);
    }
    if (type.kind == Kind::enumeration) {
        std::string values;
        for (auto const& [name, value] : type.values) {
            values += fmt::format(R"({}"{}":{})", values.empty() ? "" : ",", name, value);
        }
        out += fmt::format(R"(,"name":"{}","values":{{{}}})", type.name, values);
    }
    if (type.kind == Kind::structure) {
        out += fmt::format(R"(,"name":"{}","members":[)", type.name);
        for (std::size_t i = 0; i < type.members.size(); ++i) {
            out += fmt::format(R"({}{{"name":"{}","offset":{},"type":{}}})", i == 0 ? "" : ",", type.members[i].name,
                               place.offsets[i], json_of(layout, type.members[i].type));
        }
        out += ']';
    }
    return out + '}';
}

} // namespace

Result<NativeLayout> NativeLayout::create(std::shared_ptr<Model const> model, std::string_view name) {
    auto const type = model->find(name);
    if (!type || model->types[*type].kind != Kind::structure) {
        return fail(ExitCode::usage, fmt::format("its IDL has no struct '{}'", name));
    }
    NativeLayout out{std::move(model), *type};
    if (auto ok = out.lay_out(*type, 0); !ok) {
        return std::unexpected{ok.error()};
    }
    return out;
}

NativeLayout::NativeLayout(std::shared_ptr<Model const> model, std::size_t type)
    : model_{std::move(model)}, type_{type}, places_(model_->types.size()) {}

Result<void> NativeLayout::lay_out(std::size_t index, int depth) {
    Type const& type = model_->types[index];
    Place& place = places_[index];
    if (place.size != 0) {
        return {};
    }
    if (!type.unsupported.empty() || depth > kMaxLayoutDepth) {
        return fail(ExitCode::usage, fmt::format("'{}' has no layout in memory: {}", type.name,
                                                 type.unsupported.empty() ? "it is too deep" : type.unsupported));
    }
    switch (type.kind) {
    case Kind::string:
        place = {sizeof(char const*), alignof(char const*), 5, {}};
        return {};
    case Kind::sequence:
        place = {sizeof(NativeSequence), alignof(NativeSequence), 4, {}};
        return lay_out(type.element, depth + 1);
    case Kind::array: {
        if (auto ok = lay_out(type.element, depth + 1); !ok) {
            return ok;
        }
        Place const& element = places_[type.element];
        place = {element.size * type.bound, element.align, element.min_cdr * type.bound, {}};
        break;
    }
    case Kind::structure: {
        Place whole;
        for (Type::Member const& member : type.members) {
            if (auto ok = lay_out(member.type, depth + 1); !ok) {
                return ok;
            }
            Place const& part = places_[member.type];
            whole.offsets.push_back(aligned(whole.size, part.align));
            whole.size = whole.offsets.back() + part.size;
            whole.align = std::max(whole.align, part.align);
            whole.min_cdr += part.min_cdr;
        }
        whole.size = aligned(whole.size, whole.align);
        place = std::move(whole);
        break;
    }
    default: {
        std::size_t const octets = octets_of(type.kind);
        place = {octets, octets, type.kind == Kind::enumeration ? type.octets : octets, {}};
    }
    }
    if (place.size == 0 || place.size > kMaxOctets) {
        return fail(ExitCode::usage, fmt::format("'{}' has no layout in memory: it {}", type.name,
                                                 place.size == 0 ? "is empty" : "is too large"));
    }
    return {};
}

std::optional<std::size_t> NativeLayout::offset_of(std::string_view member, Kind kind) const {
    std::vector<Type::Member> const& members = root().members;
    for (std::size_t i = 0; i < members.size(); ++i) {
        if (members[i].name == member && model_->types[members[i].type].kind == kind) {
            return places_[type_].offsets[i];
        }
    }
    return std::nullopt;
}

std::string to_json(NativeLayout const& layout) {
    return json_of(layout, layout.type());
}

} // namespace gridspace::idl

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/scl/data_types.hpp"

#include "common/text.hpp"

#include <array>
#include <charconv>
#include <fmt/format.h>

namespace gridspace::scl {
namespace {

using iec61850::BasicType;
using iec61850::DataNode;

constexpr int kDeepest = 16;
constexpr std::size_t kLongest = 1000; // elements of an array

struct Basic {
    char const* name;
    BasicType type;
    std::uint16_t length;
};
/// The first of several names of a type is the one that is written.
constexpr std::array<Basic, 31> kBasics{{
    {"BOOLEAN", BasicType::boolean, 0},
    {"INT8", BasicType::int8, 0},
    {"INT16", BasicType::int16, 0},
    {"INT32", BasicType::int32, 0},
    {"INT24", BasicType::int32, 0},
    {"INT64", BasicType::int64, 0},
    {"INT128", BasicType::int64, 0},
    {"INT8U", BasicType::uint8, 0},
    {"INT16U", BasicType::uint16, 0},
    {"INT32U", BasicType::uint32, 0},
    {"INT24U", BasicType::uint32, 0},
    {"INT64U", BasicType::uint64, 0},
    {"FLOAT32", BasicType::float32, 0},
    {"FLOAT64", BasicType::float64, 0},
    {"Enum", BasicType::enumerated, 0},
    {"Dbpos", BasicType::position, 0},
    {"Tcmd", BasicType::position, 0},
    {"Quality", BasicType::quality, 0},
    {"Timestamp", BasicType::timestamp, 0},
    {"EntryTime", BasicType::entry_time, 0},
    {"VisString255", BasicType::visible_string, 255},
    {"VisString129", BasicType::visible_string, 129},
    {"VisString65", BasicType::visible_string, 65},
    {"VisString64", BasicType::visible_string, 64},
    {"VisString32", BasicType::visible_string, 32},
    {"ObjRef", BasicType::visible_string, 129},
    {"Currency", BasicType::visible_string, 3},
    {"Octet64", BasicType::octet_string, 64},
    {"EntryID", BasicType::octet_string, 8},
    {"Check", BasicType::bit_string, 2},
    {"OptFlds", BasicType::bit_string, 10},
}};

} // namespace

std::optional<DataNode> basic_node(std::string const& b_type, std::string name) {
    for (Basic const& basic : kBasics) {
        if (b_type == basic.name) {
            return DataNode::leaf(std::move(name), basic.type, basic.length);
        }
    }
    return std::nullopt;
}

std::string b_type_of(iec61850::Leaf const& leaf) {
    bool const exact = leaf.type == BasicType::bit_string;
    std::string best;
    for (Basic const& basic : kBasics) { // the shortest text that is long enough: the table goes down
        std::string_view const name = basic.name;
        bool const general = name != "ObjRef" && (name != "EntryID" || leaf.length == basic.length);
        bool const fits = exact                            ? basic.length == leaf.length
                          : iec61850::is_string(leaf.type) ? basic.length >= leaf.length
                                                           : true;
        if (basic.type == leaf.type && fits && general && (best.empty() || iec61850::is_string(leaf.type))) {
            best = basic.name;
        }
    }
    return best;
}

DataTypes::DataTypes(Element const* templates) {
    if (templates == nullptr) {
        return;
    }
    for (Element const* e = templates->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
        by_id_[{std::string{local_name(*e)}, attribute(*e, "id")}] = e;
    }
}

Element const* DataTypes::find(char const* kind, std::string const& id) const {
    auto const found = by_id_.find({kind, id});
    return found == by_id_.end() ? nullptr : found->second;
}

namespace {

/// How many elements the array `definition` has: 0 when it is none; nothing when it does not say so by a number.
std::optional<std::size_t> array_size(Element const& definition) {
    std::string const count = attribute(definition, "count", "0");
    std::size_t size = 0;
    auto const [end, ec] = std::from_chars(count.data(), count.data() + count.size(), size);
    return ec == std::errc{} && end == count.data() + count.size() && size <= kLongest ? std::optional{size}
                                                                                       : std::nullopt;
}

std::size_t leaves_in(DataNode const& node) {
    std::size_t out = node.kind == DataNode::Kind::leaf ? 1 : 0;
    for (DataNode const& member : node.members) {
        out += leaves_in(member);
    }
    return out;
}

std::unexpected<Error> needs_index(Element const& array) {
    return fail(ExitCode::usage, fmt::format("'{}' is an array", attribute(array, "name")),
                "a member behind it needs an index (ix)");
}

std::unexpected<Error> too_deep(char const* kind, Element const& type) {
    return fail(
        ExitCode::usage,
        fmt::format("the types are nested more than {} levels deep at {} '{}'", kDeepest, kind, attribute(type, "id")),
        "it may contain itself");
}

} // namespace

Result<void> DataTypes::spend(std::size_t leaves) const {
    spent_ += leaves;
    return spent_ <= kMostLeaves ? Result<void>{}
                                 : fail(ExitCode::usage, fmt::format("it has more than {} values", kMostLeaves),
                                        "no frame holds so many: types or arrays in it are nested");
}

Result<DataNode> DataTypes::in_array(Element const& definition, std::string name, Result<DataNode> element) const {
    auto const size = array_size(definition);
    if (!size) {
        return fail(ExitCode::usage, fmt::format("the array '{}' has {} elements", attribute(definition, "name"),
                                                 attribute(definition, "count")));
    }
    if (*size == 0 || !element) {
        return element;
    }
    if (auto const ok = spend((*size - 1) * leaves_in(*element)); !ok) {
        return std::unexpected{ok.error()};
    }
    element->name.clear();
    return DataNode{std::move(name), DataNode::Kind::array, {}, 0, std::vector<DataNode>(*size, *element)};
}

Result<DataNode> DataTypes::attribute_of(Element const& definition, Path path, std::string name, int depth) const {
    if (array_size(definition) == std::size_t{0} || path.indexed) {
        return element_of(definition, path, std::move(name), depth);
    }
    if (!path.last()) {
        return needs_index(definition);
    }
    return in_array(definition, name, element_of(definition, path, name, depth));
}

Result<DataNode> DataTypes::element_of(Element const& definition, Path path, std::string name, int depth) const {
    std::string const b_type = attribute(definition, "bType");
    if (b_type != "Struct") {
        auto node = path.last() ? basic_node(b_type, name) : std::nullopt;
        if (!node) {
            return fail(ExitCode::usage, fmt::format("'{}' has the type {}", join(path.parts, "."), b_type),
                        path.last() ? "it has no place in a stream" : "it has no attributes");
        }
        if (auto const ok = spend(1); !ok) {
            return std::unexpected{ok.error()};
        }
        return *node;
    }
    Element const* const type = find("DAType", attribute(definition, "type"));
    if (type == nullptr) {
        return fail(ExitCode::usage, fmt::format("there is no DAType '{}'", attribute(definition, "type")));
    }
    if (depth > kDeepest) {
        return too_deep("DAType", *type);
    }
    if (auto const ok = spend(1); !ok) {
        return std::unexpected{ok.error()};
    }
    if (!path.last()) {
        std::string const& wanted = path.parts[path.at + 1];
        for (Element const* part : children(*type, "BDA")) {
            if (attribute(*part, "name") == wanted) {
                return attribute_of(*part, {path.parts, path.at + 1, path.indexed}, std::move(name), depth + 1);
            }
        }
        return fail(ExitCode::usage, fmt::format("'{}' has no attribute '{}'", attribute(*type, "id"), wanted));
    }
    DataNode structure{std::move(name), DataNode::Kind::structure, {}, 0, {}};
    for (Element const* part : children(*type, "BDA")) {
        std::vector<std::string> const own{attribute(*part, "name")};
        auto member = attribute_of(*part, {own}, own[0], depth + 1);
        if (!member) {
            return member;
        }
        structure.members.push_back(std::move(*member));
    }
    return structure;
}

Result<DataNode> DataTypes::object_node(Element const& type, std::string const& constraint, std::string name,
                                        int depth) const {
    if (depth > kDeepest) {
        return too_deep("DOType", type);
    }
    if (auto const ok = spend(1); !ok) { // also of those without a value
        return std::unexpected{ok.error()};
    }
    DataNode structure{std::move(name), DataNode::Kind::structure, {}, 0, {}};
    for (Element const* e = type.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
        std::vector<std::string> const own{attribute(*e, "name")};
        if (local_name(*e) == "DA" && attribute(*e, "fc") == constraint) {
            auto member = attribute_of(*e, {own}, own[0], depth + 1);
            if (!member) {
                return member;
            }
            structure.members.push_back(std::move(*member));
        } else if (local_name(*e) == "SDO") {
            Element const* const inner = find("DOType", attribute(*e, "type"));
            if (inner == nullptr) {
                continue; // it may be none of this constraint
            }
            auto member = object_node(*inner, constraint, own[0], depth + 1);
            if (!member) {
                return member;
            }
            if (member->members.empty()) {
                continue;
            }
            member = in_array(*e, own[0], std::move(member));
            if (!member) {
                return member;
            }
            structure.members.push_back(std::move(*member));
        }
    }
    return structure;
}

/// The object that `reference` ends in. Data objects at the start of the attribute's path, as some tools
/// write them ("phsA.cVal.mag.f" of "A"), are gone through too and taken off it.
Result<DataTypes::Object> DataTypes::object_of(Reference& reference) const {
    Element const* type = find("LNodeType", reference.ln_type);
    Element const* array = nullptr; // that was named last
    if (type == nullptr) {
        return fail(ExitCode::usage, fmt::format("there is no LNodeType '{}'", reference.ln_type));
    }
    auto const part_of = [](Element const& parent, char const* kind, std::string_view name) -> Element const* {
        for (Element const* e : children(parent, kind)) {
            if (attribute(*e, "name") == name) {
                return e;
            }
        }
        return nullptr;
    };
    auto const enter = [&](Element const* part) -> Result<void> {
        if (array != nullptr) {
            return needs_index(*array);
        }
        type = part == nullptr ? nullptr : find("DOType", attribute(*part, "type"));
        if (type == nullptr) {
            return fail(ExitCode::usage,
                        fmt::format("type '{}' has no data object '{}'", reference.ln_type, reference.object));
        }
        array = array_size(*part) != std::size_t{0} && !reference.indexed ? part : nullptr;
        return {};
    };
    char const* kind = "DO";
    for (std::string const& name : split(reference.object, '.')) {
        if (auto ok = enter(part_of(*type, kind, name)); !ok) {
            return std::unexpected{ok.error()};
        }
        kind = "SDO";
    }
    while (!reference.attribute.empty()) {
        std::string const name = reference.attribute.substr(0, reference.attribute.find('.'));
        Element const* const sdo = part_of(*type, "SDO", name);
        if (sdo == nullptr || part_of(*type, "DA", name) != nullptr) {
            break;
        }
        if (auto ok = enter(sdo); !ok) {
            return std::unexpected{ok.error()};
        }
        reference.attribute.erase(0, name.size() + 1);
    }
    if (array != nullptr && !reference.attribute.empty()) {
        return needs_index(*array);
    }
    return Object{type, array};
}

Result<DataNode> DataTypes::resolve(Reference const& reference, std::string name) const {
    Reference r = reference;
    spent_ = 0;
    auto const object = object_of(r);
    if (!object) {
        return std::unexpected{object.error()};
    }
    if (r.attribute.empty()) {
        auto node = object_node(*object->type, r.constraint, name, 0);
        if (node && node->members.empty()) {
            return fail(ExitCode::usage,
                        fmt::format("'{}' has nothing with the constraint {}", r.object, r.constraint));
        }
        return object->array == nullptr ? node : in_array(*object->array, std::move(name), std::move(node));
    }
    std::vector<std::string> const path = split(r.attribute, '.');
    for (Element const* e : children(*object->type, "DA")) {
        if (attribute(*e, "name") == path[0]) {
            return attribute_of(*e, {path, 0, r.indexed}, std::move(name), 0);
        }
    }
    return fail(ExitCode::usage, fmt::format("'{}' has no attribute '{}'", r.object, path[0]));
}

namespace {

Element const* named(Element const& parent, char const* kind, std::string_view name) {
    for (Element const* e : children(parent, kind)) {
        if (attribute(*e, "name") == name) {
            return e;
        }
    }
    return nullptr;
}

/// The number in `<Val>`; an element without one keeps `out`.
void read_value(Element const* e, double& out) {
    Element const* const value = e == nullptr ? nullptr : child(*e, "Val");
    if (value != nullptr) {
        std::string const text = text_of(*value);
        double number = 0;
        auto const [end, ec] = std::from_chars(text.data(), text.data() + text.size(), number);
        out = ec == std::errc{} && end == text.data() + text.size() ? number : out;
    }
}

} // namespace

DataTypes::Scale DataTypes::scale_of(Element const& ln, std::string const& object) const {
    Scale out;
    Element const* const type = find("LNodeType", attribute(ln, "lnType"));
    Element const* const defined = type == nullptr ? nullptr : named(*type, "DO", object);
    Element const* const object_type = defined == nullptr ? nullptr : find("DOType", attribute(*defined, "type"));
    Element const* const svc = object_type == nullptr ? nullptr : named(*object_type, "DA", "sVC");
    if (Element const* const parts = svc == nullptr ? nullptr : find("DAType", attribute(*svc, "type"))) {
        read_value(named(*parts, "BDA", "scaleFactor"), out.factor);
        read_value(named(*parts, "BDA", "offset"), out.offset);
    }
    Element const* const instance = named(ln, "DOI", object);
    if (Element const* const set = instance == nullptr ? nullptr : named(*instance, "SDI", "sVC")) {
        read_value(named(*set, "DAI", "scaleFactor"), out.factor);
        read_value(named(*set, "DAI", "offset"), out.offset);
    }
    return out;
}

} // namespace gridspace::scl

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/scl/data_types.hpp"

#include "common/text.hpp"

#include <array>
#include <fmt/format.h>

namespace gridspace::scl {
namespace {

using iec61850::BasicType;
using iec61850::DataNode;

constexpr int kDeepest = 16;

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
    std::string best;
    for (Basic const& basic : kBasics) { // the shortest string that is long enough: the table goes down
        bool const fits = basic.type == leaf.type && (!iec61850::is_string(leaf.type) || basic.length >= leaf.length);
        if (fits && (best.empty() || iec61850::is_string(leaf.type)) && std::string_view{basic.name} != "ObjRef") {
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

Result<DataNode> DataTypes::attribute_of(Element const& definition, std::vector<std::string> const& path,
                                         std::size_t at, std::string const& constraint, std::string name,
                                         int depth) const {
    std::string const b_type = attribute(definition, "bType");
    bool const last = at + 1 >= path.size();
    if (b_type != "Struct") {
        auto node = last ? basic_node(b_type, name) : std::nullopt;
        if (!node) {
            return fail(ExitCode::usage, fmt::format("'{}' has the type {}", join(path, "."), b_type),
                        last ? "it has no place in a stream" : "it has no attributes");
        }
        return *node;
    }
    Element const* const type = find("DAType", attribute(definition, "type"));
    if (type == nullptr || depth > kDeepest) {
        return fail(ExitCode::usage, fmt::format("there is no DAType '{}'", attribute(definition, "type")));
    }
    DataNode structure{std::move(name), DataNode::Kind::structure, {}, 0, {}};
    for (Element const* part : children(*type, "BDA")) {
        std::string const own = attribute(*part, "name");
        if (!last && own == path[at + 1]) {
            return attribute_of(*part, path, at + 1, constraint, structure.name, depth + 1);
        }
        if (last) {
            auto member = attribute_of(*part, {own}, 0, constraint, own, depth + 1);
            if (!member) {
                return member;
            }
            structure.members.push_back(std::move(*member));
        }
    }
    if (!last) {
        return fail(ExitCode::usage, fmt::format("'{}' has no attribute '{}'", attribute(*type, "id"), path[at + 1]));
    }
    return structure;
}

Result<DataNode> DataTypes::object_node(Element const& type, std::string const& constraint, std::string name,
                                        int depth) const {
    DataNode structure{std::move(name), DataNode::Kind::structure, {}, 0, {}};
    for (Element const* e = type.FirstChildElement(); e != nullptr && depth <= kDeepest; e = e->NextSiblingElement()) {
        std::string const own = attribute(*e, "name");
        if (local_name(*e) == "DA" && attribute(*e, "fc") == constraint) {
            auto member = attribute_of(*e, {own}, 0, constraint, own, depth + 1);
            if (!member) {
                return member;
            }
            structure.members.push_back(std::move(*member));
        } else if (local_name(*e) == "SDO") {
            if (Element const* const inner = find("DOType", attribute(*e, "type"))) {
                auto member = object_node(*inner, constraint, own, depth + 1);
                if (member && !member->members.empty()) {
                    structure.members.push_back(std::move(*member));
                }
            }
        }
    }
    return structure;
}

Result<DataNode> DataTypes::resolve(std::string const& ln_type, std::string const& object,
                                    std::string const& attribute_path, std::string const& constraint,
                                    std::string name) const {
    Element const* const ln = find("LNodeType", ln_type);
    if (ln == nullptr) {
        return fail(ExitCode::usage, fmt::format("there is no LNodeType '{}'", ln_type));
    }
    std::vector<std::string> const objects = split(object, '.');
    Element const* type = nullptr;
    for (Element const* e : children(*ln, "DO")) {
        if (attribute(*e, "name") == objects[0]) {
            type = find("DOType", attribute(*e, "type"));
        }
    }
    for (std::size_t i = 1; i < objects.size() && type != nullptr; ++i) {
        Element const* next = nullptr;
        for (Element const* e : children(*type, "SDO")) {
            if (attribute(*e, "name") == objects[i]) {
                next = find("DOType", attribute(*e, "type"));
            }
        }
        type = next;
    }
    if (type == nullptr) {
        return fail(ExitCode::usage, fmt::format("type '{}' has no data object '{}'", ln_type, object));
    }
    if (attribute_path.empty()) {
        auto node = object_node(*type, constraint, std::move(name), 0);
        if (node && node->members.empty()) {
            return fail(ExitCode::usage, fmt::format("'{}' has nothing with the constraint {}", object, constraint));
        }
        return node;
    }
    std::vector<std::string> const path = split(attribute_path, '.');
    for (Element const* e : children(*type, "DA")) {
        if (attribute(*e, "name") == path[0]) {
            return attribute_of(*e, path, 0, constraint, std::move(name), 0);
        }
    }
    return fail(ExitCode::usage, fmt::format("'{}' has no attribute '{}'", object, path[0]));
}

} // namespace gridspace::scl

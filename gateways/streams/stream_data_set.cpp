// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/streams/stream_data_set.hpp"

#include "common/text.hpp"

#include <fmt/format.h>

namespace gridspace::streams {
namespace {

using config::Fields;
using config::Node;
using iec61850::DataNode;

std::optional<DataNode> read_member(std::string const& name, Node const& node, std::string& problem);

/// `h: {array: float32, count: 3}`.
std::optional<DataNode> read_array(std::string const& name, Node const& node, Node const& element,
                                   std::string& problem) {
    Node const* const count = node.find("count");
    auto const value = count == nullptr ? std::nullopt : config::number_of(*count);
    if (!value || *value < 1 || *value > 1000 || *value != static_cast<int>(*value)) {
        problem = fmt::format("the array '{}' needs a whole `count` of 1 to 1000", name);
        return std::nullopt;
    }
    auto member = read_member("", element, problem);
    if (!member) {
        return std::nullopt;
    }
    return DataNode{name, DataNode::Kind::array, iec61850::BasicType::boolean, 0,
                    std::vector<DataNode>(static_cast<std::size_t>(*value), *member)};
}

/// `id: {type: visible_string, length: 20}`.
std::optional<DataNode> read_leaf(std::string const& name, Node const& node, Node const& type, std::string& problem) {
    auto leaf = read_member(name, type, problem);
    if (Node const* length = node.find("length"); leaf && length != nullptr) {
        auto const value = config::number_of(*length);
        if (!value || *value < 1 || *value > 255) {
            problem = fmt::format("the length of '{}' is '{}'", name, length->text);
            return std::nullopt;
        }
        leaf->length = static_cast<std::uint16_t>(*value);
    }
    return leaf;
}

/// A member of a data set: `Ia: float32`, `id: {type: visible_string, length: 20}`, `h: {array: float32, count: 3}`, a
/// list of types (an array too), or a map of members (a structure).
std::optional<DataNode> read_member(std::string const& name, Node const& node, std::string& problem) {
    if (node.is_scalar()) {
        if (auto const type = iec61850::parse_type(node.text)) {
            return DataNode::leaf(name, *type);
        }
        auto const near = nearest_spelling(node.text, iec61850::type_names());
        problem =
            fmt::format("'{}' is not a type{}", node.text, near ? fmt::format("; did you mean '{}'?", *near) : "");
        return std::nullopt;
    }
    if (node.is_sequence() && !node.items.empty()) {
        DataNode array{name, DataNode::Kind::array, iec61850::BasicType::boolean, 0, {}};
        for (Node const& item : node.items) {
            auto member = read_member("", item, problem);
            if (!member) {
                return std::nullopt;
            }
            array.members.push_back(std::move(*member));
        }
        return array;
    }
    if (!node.is_map() || node.entries.empty()) {
        problem = fmt::format("'{}' is {}", name, config::describe(node));
        return std::nullopt;
    }
    if (Node const* element = node.find("array")) {
        return read_array(name, node, *element, problem);
    }
    if (Node const* type = node.find("type"); type != nullptr && type->is_scalar()) {
        return read_leaf(name, node, *type, problem);
    }
    DataNode structure{name, DataNode::Kind::structure, iec61850::BasicType::boolean, 0, {}};
    for (Node::Entry const& entry : node.entries) {
        auto member = read_member(entry.key, entry.value, problem);
        if (!member) {
            return std::nullopt;
        }
        structure.members.push_back(std::move(*member));
    }
    return structure;
}

} // namespace

void describe_data_set(Fields& f, Stream& stream) {
    Node node;
    f.raw("data_set", node, {.doc = "members and their types in the order of the wire, or 9-2LE", .required = true});
    if (node.is_null()) {
        return;
    }
    if (node.is_scalar()) {
        if (stream.kind == Kind::smv && node.text == "9-2LE") {
            stream.data_set = iec61850::data_set_92le();
        } else {
            f.error("data_set", fmt::format("the data set is '{}'", node.text),
                    "expected a map from names to types, or 9-2LE for sampled values");
        }
        return;
    }
    if (!node.is_map() || node.entries.empty()) {
        f.error("data_set",
                node.is_map() ? "the data set is empty" : fmt::format("the data set is {}", config::describe(node)),
                "expected a map from names to types");
        return;
    }
    for (Node::Entry const& entry : node.entries) {
        std::string problem;
        if (auto member = read_member(entry.key, entry.value, problem)) {
            stream.data_set.members.push_back(std::move(*member));
        } else {
            f.error("data_set", fmt::format("member '{}': {}", entry.key, problem),
                    fmt::format("types: {}", join(iec61850::type_names(), ", ")));
        }
    }
}

} // namespace gridspace::streams

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/data_set.hpp"

#include <fmt/format.h>

namespace gridspace::iec61850 {
namespace {

void collect(DataNode const& node, std::string const& name, std::vector<Leaf>& out) {
    if (node.kind == DataNode::Kind::leaf) {
        out.push_back({name, node.type, node.length != 0 ? node.length : default_length(node.type)});
        return;
    }
    for (std::size_t i = 0; i < node.members.size(); ++i) {
        DataNode const& member = node.members[i];
        collect(member, member.name.empty() ? fmt::format("{}.{}", name, i) : fmt::format("{}.{}", name, member.name),
                out);
    }
}

} // namespace

std::vector<Leaf> leaves_of(DataSet const& data_set) {
    std::vector<Leaf> out;
    for (DataNode const& member : data_set.members) {
        collect(member, member.name, out);
    }
    return out;
}

std::uint16_t default_length(BasicType type) noexcept {
    switch (type) {
    case BasicType::visible_string:
        return 35;
    case BasicType::octet_string:
        return 20;
    case BasicType::bit_string:
        return 32;
    default:
        return 0;
    }
}

std::optional<std::size_t> time_next_to(std::vector<Leaf> const& leaves, std::size_t leaf) {
    std::string const& name = leaves[leaf].name;
    std::string const wanted = name.substr(0, name.rfind('.') + 1) + "t"; // npos + 1 is 0
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        if (leaves[i].name == wanted && leaves[i].type == BasicType::timestamp) {
            return i;
        }
    }
    return std::nullopt;
}

DataSet data_set_92le() {
    DataSet out;
    for (char const* channel : {"Ia", "Ib", "Ic", "In", "Va", "Vb", "Vc", "Vn"}) {
        out.members.push_back(DataNode::leaf(channel, BasicType::int32));
        out.members.push_back(DataNode::leaf(fmt::format("{}_q", channel), BasicType::quality));
    }
    return out;
}

} // namespace gridspace::iec61850

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "gateways/iec61850/data_set.hpp"
#include "gateways/scl/xml.hpp"

#include <map>

namespace gridspace::scl {

/// The section DataTypeTemplates: what a path like AmpSv.instMag.f of a logical node type is.
class DataTypes {
  public:
    /// `templates` may be null: then no path resolves.
    explicit DataTypes(Element const* templates);

    /// The member that a functionally constrained reference names: a leaf, or a structure when it ends above one.
    /// `attribute` may be empty: then all attributes of the object with that constraint.
    [[nodiscard]] Result<iec61850::DataNode> resolve(std::string const& ln_type, std::string const& object,
                                                     std::string const& attribute, std::string const& constraint,
                                                     std::string name) const;

  private:
    using Node = iec61850::DataNode;
    [[nodiscard]] Result<Node> attribute_of(Element const& definition, std::vector<std::string> const& path,
                                            std::size_t at, std::string const& constraint, std::string name,
                                            int depth) const;
    [[nodiscard]] Result<Node> object_node(Element const& type, std::string const& constraint, std::string name,
                                           int depth) const;
    [[nodiscard]] Element const* find(char const* kind, std::string const& id) const;

    std::map<std::pair<std::string, std::string>, Element const*> by_id_;
};

/// A basic type of SCL ("INT32", "Dbpos", "VisString255"); nothing for those that have no place in a stream.
[[nodiscard]] std::optional<iec61850::DataNode> basic_node(std::string const& b_type, std::string name);
/// The other way round.
[[nodiscard]] std::string b_type_of(iec61850::Leaf const& leaf);

} // namespace gridspace::scl

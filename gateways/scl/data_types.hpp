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

    /// A functionally constrained reference, in the words of an FCDA.
    struct Reference {
        std::string ln_type, object, attribute; ///< `attribute` empty: all of the object with the constraint
        std::string constraint;
        bool indexed{false}; ///< one element of the array on the way
    };
    /// How a raw value becomes one in units (sVC): raw * factor + offset. A factor of 0: the file does not say.
    struct Scale {
        double factor{0}, offset{0};
    };
    /// Of a data object of the logical node `ln`: what the node says (DOI), else its type.
    [[nodiscard]] Scale scale_of(Element const& ln, std::string const& object) const;
    /// The member that it names: a leaf, a structure when it ends above one, or an array.
    [[nodiscard]] Result<iec61850::DataNode> resolve(Reference const& reference, std::string name) const;

  private:
    using Node = iec61850::DataNode;
    /// What is left of a path, and whether an array on it may be passed.
    struct Path {
        std::vector<std::string> const& parts;
        std::size_t at{0};
        bool indexed{false};
        [[nodiscard]] bool last() const { return at + 1 >= parts.size(); }
    };
    [[nodiscard]] Result<Node> attribute_of(Element const& definition, Path path, std::string name, int depth) const;
    [[nodiscard]] Result<Node> element_of(Element const& definition, Path path, std::string name, int depth) const;
    [[nodiscard]] Result<Node> object_node(Element const& type, std::string const& constraint, std::string name,
                                           int depth) const;
    struct Object {
        Element const* type;  ///< its DOType
        Element const* array; ///< where it is defined, when all elements of an array are meant; otherwise null
    };
    [[nodiscard]] Result<Object> object_of(Reference& reference) const;
    [[nodiscard]] Element const* find(char const* kind, std::string const& id) const;

    /// Types may be nested so that a few lines stand for millions of members: no frame holds more than these.
    static constexpr std::size_t kMostLeaves = 4096;
    [[nodiscard]] Result<Node> in_array(Element const& definition, std::string name, Result<Node> element) const;
    [[nodiscard]] Result<void> spend(std::size_t leaves) const;
    mutable std::size_t spent_{0}; ///< leaves of the reference that is being resolved

    std::map<std::pair<std::string, std::string>, Element const*> by_id_;
};

/// A basic type of SCL ("INT32", "Dbpos", "VisString255"); nothing for those that have no place in a stream.
[[nodiscard]] std::optional<iec61850::DataNode> basic_node(std::string const& b_type, std::string name);
/// The other way round: of strings the shortest that is long enough. Empty when there is none.
[[nodiscard]] std::string b_type_of(iec61850::Leaf const& leaf);

} // namespace gridspace::scl

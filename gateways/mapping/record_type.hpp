// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/idl/idl_model.hpp"
#include "gateways/mapping/mapping.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::mapping {

/// A DDS type as a flat list of basic fields, made from its IDL: "status", "pos.q", "harm.2", "evs.0.soc_percent"
/// (spelt as the leaves of a data set). What is needed to read and write samples of a type that the program was not
/// compiled for (plain CDR, XCDR1, @final types).
///
/// One sequence of the type may be chosen as `each`: its elements are then consecutive samples, and their fields are
/// named without an index ("samples.ia").
class RecordType {
  public:
    /// Of a sequence so many elements can be named. A type may have so many fields.
    static constexpr std::uint32_t kElements = 64;
    static constexpr std::size_t kMaxFields = 16384;
    static constexpr std::uint16_t kTextOctets = 255; ///< of an unbounded string

    /// Fails when `type` is not a struct of the model, when it contains itself or too many fields, or when `each` is
    /// not one of its sequences at the top level.
    [[nodiscard]] static Result<RecordType> create(idl::Model const& model, std::string_view type,
                                                   std::string_view each = {});

    [[nodiscard]] std::string const& name() const noexcept { return name_; }
    /// Fields in the order of the type; those of an element of `each` stand together.
    [[nodiscard]] std::vector<Field> const& fields() const noexcept { return fields_; }
    [[nodiscard]] std::optional<std::size_t> index_of(std::string_view field) const noexcept;
    /// Names of the enumerators, for a field of an enumeration; empty for others.
    [[nodiscard]] std::vector<std::pair<std::string, std::int32_t>> const& enumerators(std::size_t field) const;

    [[nodiscard]] bool keyed() const noexcept { return keyed_; }
    /// Upper bound of the octets of a sample with its encapsulation header; 0: unbounded, or more than 64 kB.
    [[nodiscard]] std::uint32_t max_octets() const noexcept { return max_octets_; }

    // What reader and writer walk through:
    static constexpr std::uint32_t kNone = 0xFFFFFFFF;
    enum class Shape : std::uint8_t { leaf, structure, sequence, array };
    struct Node {
        Shape shape{Shape::leaf};
        idl::Kind kind{idl::Kind::boolean}; ///< of a leaf
        std::uint32_t bound{0};             ///< of strings and sequences (0: none); length of an array
        std::uint32_t first_field{0};       ///< of what stands below it
        std::uint32_t stride{0};            ///< fields of one element
        std::uint32_t slots{0};             ///< elements that have fields
        bool is_each{false}, is_key{false};
        std::vector<Node> children; ///< members, or the one element
    };
    [[nodiscard]] Node const& root() const noexcept { return root_; }
    [[nodiscard]] std::uint32_t first_each_field() const noexcept { return each_first_; } ///< kNone without `each`
    [[nodiscard]] std::uint32_t each_fields() const noexcept { return each_count_; }
    [[nodiscard]] std::uint32_t each_bound() const noexcept { return each_bound_; } ///< most elements; 0: no bound
    [[nodiscard]] bool is_each_field(std::size_t field) const noexcept {
        return each_first_ != kNone && field >= each_first_ && field < each_first_ + each_count_;
    }

  private:
    struct Builder;
    std::string name_;
    std::vector<Field> fields_;
    std::vector<std::uint32_t> enum_of_; ///< by field: index in enums_, or kNone
    std::vector<std::vector<std::pair<std::string, std::int32_t>>> enums_;
    Node root_;
    std::uint32_t each_first_{kNone}, each_count_{0}, each_bound_{0};
    std::uint32_t max_octets_{0};
    bool keyed_{false};
};

/// The basic type of an IDL type as mappings see it: an enumeration is `enumerated`, a char its code.
[[nodiscard]] BasicType basic_type(idl::Kind kind) noexcept;

/// Octets and alignment of a number or a string's length in CDR.
[[nodiscard]] std::uint32_t cdr_octets(idl::Kind kind) noexcept;

} // namespace gridspace::mapping

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/idl/idl_model.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::idl {

/// A sequence in memory: `length` items one behind the other.
struct NativeSequence {
    std::uint32_t length;
    void const* items; ///< may be null when there are none
};

/// How a struct of IDL lies in memory as a struct of C: members in their order, each aligned as the compiler does it.
///
/// | IDL | C |
/// |---|---|
/// | boolean, octet, char, integers, float, double | bool, uint8_t, char, intN_t and uintN_t, float, double |
/// | enum | int32_t, the value's number |
/// | string | char const*, ends with NUL |
/// | sequence<T> | struct { uint32_t length; T const* items; } |
/// | T name[n], a struct | T name[n], the struct itself |
class NativeLayout {
  public:
    /// Of the struct `name` of the model. Fails for what C has no struct for: unions, maps, a struct without members.
    [[nodiscard]] static Result<NativeLayout> create(std::shared_ptr<Model const> model, std::string_view name);

    struct Place {
        std::size_t size{0}, align{1};
        std::size_t min_cdr{0};           ///< octets that a value has on the wire at the least, without padding
        std::vector<std::size_t> offsets; ///< of a struct: where each member begins
    };
    [[nodiscard]] Model const& model() const { return *model_; }
    [[nodiscard]] std::size_t type() const { return type_; }
    [[nodiscard]] Type const& root() const { return model_->types[type_]; }
    [[nodiscard]] Place const& place(std::size_t type) const { return places_[type]; }
    [[nodiscard]] std::size_t size() const { return places_[type_].size; }
    /// Where the member of the root that has this name and kind begins; nothing when it has none.
    [[nodiscard]] std::optional<std::size_t> offset_of(std::string_view member, Kind kind) const;

  private:
    NativeLayout(std::shared_ptr<Model const> model, std::size_t type);
    [[nodiscard]] Result<void> lay_out(std::size_t type, int depth);
    std::shared_ptr<Model const> model_;
    std::size_t type_;
    std::vector<Place> places_; ///< by type; empty for those that the root does not need
};

/// The layout as JSON, for languages that build their structs when they run (docs/reference/c_abi.md).
[[nodiscard]] std::string to_json(NativeLayout const& layout);

} // namespace gridspace::idl

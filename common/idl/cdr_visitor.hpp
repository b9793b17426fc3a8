// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/idl/idl_model.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace gridspace::idl {

/// A decoded leaf. Enum values come as their number; the name is in the type.
using Value = std::variant<bool, std::int64_t, std::uint64_t, double, std::string>;

[[nodiscard]] std::string to_text(Value const& value);
[[nodiscard]] double to_number(Value const& value); ///< NaN for a text

/// Called for every leaf with its path ("evs[0].soc_percent") and type.
class Visitor {
  public:
    virtual ~Visitor() = default;
    virtual void leaf(std::string_view path, Type const& type, Value const& value) = 0;
    /// The length of a sequence, before its elements.
    virtual void sequence(std::string_view /*path*/, std::size_t /*length*/) {}
    /// Nothing more is wanted: the rest of the sample is not looked at.
    [[nodiscard]] virtual bool done() const { return false; }
};

/// Decodes one sample (plain CDR, XCDR1, with its encapsulation header) of a struct type. Never reads outside of `cdr`;
/// fails with the member at which it does not fit, or at which the visitor was done.
[[nodiscard]] Result<void> visit(Model const& model, std::size_t type, std::span<std::byte const> cdr,
                                 Visitor& visitor);

/// The int64 member of the sample that has this name, when the type has one at its top level.
[[nodiscard]] std::optional<std::int64_t> find_integer(Model const& model, std::size_t type,
                                                       std::span<std::byte const> cdr, std::string_view member);

} // namespace gridspace::idl

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/mapping/mapping.hpp"

#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace gridspace::mapping {

/// Names of an enumeration and their numbers.
using Enumerators = std::span<std::pair<std::string, std::int32_t> const>;

/// A value of the field's type, from its text: numbers (whole ones also as 0x12), true and false, "open", "closed",
/// "intermediate" and "bad" of a position, "good", "invalid", "out_of_range" and the like of a quality (several joined
/// by '|', or a number that has no more bits than the field), enumerators by name, texts. Nothing when it is not one,
/// or out of the type's range. A text points into `text`, which must stay.
[[nodiscard]] std::optional<Value> parse_constant(std::string_view text, Field const& field,
                                                  Enumerators enumerators = {});

/// What would have been right: "true or false", "open, closed, ...".
[[nodiscard]] std::string expected_constant(Field const& field, Enumerators enumerators = {});

} // namespace gridspace::mapping

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/instance.hpp"
#include "gateways/mapping/mapping.hpp"

#include <optional>
#include <string>

namespace gridspace::agents {

/// A variable as a field that can be mapped, with its unit where it is one of ours. Nothing for arrays, binaries and
/// clocks.
[[nodiscard]] std::optional<mapping::Field> field_of(fmi::Variable const& variable);

[[nodiscard]] fmi::Value to_fmi(mapping::Value const& value);
/// A text of the result points into `value`.
[[nodiscard]] mapping::Value to_mapping(fmi::Value const& value, mapping::BasicType type);

} // namespace gridspace::agents

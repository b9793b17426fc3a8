// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <optional>
#include <string_view>

namespace gridspace::launcher {

/// A number below a key of a map that was checked before; nothing when there is no map, no key, or no number.
inline std::optional<double> number_at(config::Node const* map, std::string_view key) {
    config::Node const* value = map == nullptr ? nullptr : map->find(key);
    return value == nullptr ? std::nullopt : config::number_of(*value);
}

} // namespace gridspace::launcher

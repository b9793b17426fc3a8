// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/key.hpp"
#include "common/program/declaration.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::sdk {

/// `settings` (a map that has been checked), and besides what it gives the defaults of `keys`.
[[nodiscard]] config::Node with_defaults(config::Node const& settings, std::vector<config::Key> const& keys);

/// A scalar by its path, "limits.low"; nothing where there is none.
[[nodiscard]] std::optional<std::string> setting_at(config::Node const& settings, std::string_view path);

/// As JSON. Numbers and flags are those of JSON by the kind of their key; a fraction is a text, as it was written.
[[nodiscard]] std::string to_json(config::Node const& settings, std::vector<config::Key> const& keys);

/// Values of settings as names, for the patterns of topics and signals (program::expand).
[[nodiscard]] program::Values values_of(config::Node const& settings, std::string const& process);

} // namespace gridspace::sdk

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"

#include <filesystem>
#include <optional>

namespace gridspace::config {

/// Lays `over` on `base`: maps merge by key, lists and scalars replace, `~` removes.
void merge(Node& base, Node const& over);

/// Reads a file and what it `extends:`, the nearest last. Cycles and missing files are diagnosed, at `named_at` where
/// the name of the file itself was written.
[[nodiscard]] std::optional<Node> load_extended(std::filesystem::path const& file, Diagnostics& diagnostics,
                                                SourceMark named_at = {});

/// Applies "a.b.c=value"; the value is YAML ("a.b={x: 1}" works, "a.b=~" removes, "a.b={}" empties). Missing maps on
/// the way are made. `number` counts the --set arguments from 1, for messages.
void apply_set(Node& root, std::string const& assignment, int number, Diagnostics& diagnostics);

/// Lets the entries of the map `section` inherit from each other by `like: other`; the key is consumed. The keys beside
/// it replace whole values, `~` removes.
void resolve_likes(Node& section, Diagnostics& diagnostics);

} // namespace gridspace::config

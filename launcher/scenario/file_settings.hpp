// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/key.hpp"

#include <vector>

namespace gridspace::launcher {

/// Settings of the kind `file` of a program that has said what it is, nested ones included. Those that are written are
/// relative to the file in which they stand: `check_files` says which are not there, `resolve_files` makes them whole
/// paths, because the program runs somewhere else.
void check_files(config::Node const& settings, std::vector<config::Key> const& keys, config::Diagnostics& diagnostics);
void resolve_files(config::Node& settings, std::vector<config::Key> const& keys);

} // namespace gridspace::launcher

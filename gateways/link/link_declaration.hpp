// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/program/declaration.hpp"

#include <array>

namespace gridspace::gateways {

/// Counts of frames, in the order of their columns: signals `link.{process}.*`.
inline constexpr std::array kLinkCounters{"seen", "lost", "delayed", "duplicated", "reordered", "corrupted"};

/// What a process with impairments of a cable publishes. It reads and writes nothing else: frames pass through it.
[[nodiscard]] program::Declaration link_declaration();

} // namespace gridspace::gateways

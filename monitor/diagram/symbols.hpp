// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/diagram/layout.hpp"

#include <cstddef>
#include <string_view>

namespace gridspace::diagram {

/// Adds the breakers and current transformers of one end of a branch, with the relays that look at them. Until the
/// columns have places, x is the distance from the bar, and y the number of the end: 0 at the left, 1 at the right.
/// `word`: "from" or "to", as the network calls that end. Returns how far the symbols reach.
double add_symbols(Grid const& grid, std::string_view word, std::size_t end, Route& route);

} // namespace gridspace::diagram

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/diagram/grid.hpp"

#include <vector>

namespace gridspace::diagram {

struct Cell {
    std::size_t column{0}, row{0};
    friend bool operator==(Cell const&, Cell const&) = default;
};

/// A column and a row for each bus, no two the same: by the network file, or by the distance from the first bus as far
/// as branches reach. Columns and rows that nobody uses are left out.
[[nodiscard]] std::vector<Cell> places(Grid const& grid);

} // namespace gridspace::diagram

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/diagram/places.hpp"

#include <array>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace gridspace::diagram {

/// How a branch gets from bus to bus. Its left bus is the one in the column further left, or the upper one.
struct Way {
    enum class Kind {
        upright,   ///< from bar to bar within a column
        loop,      ///< within a column, past a bar: out to the right and back
        straight,  ///< within a row
        turns,     ///< in the gap behind the left bus, then along the row of the right one
        late_turn, ///< along the row of the left bus, then in the gap before the right one
        lane       ///< both, and between the rows in a lane
    };
    Grid::Branch const* branch{nullptr};
    Kind kind{Kind::straight};
    std::size_t left{0}, right{0};
    bool turned{false};                 ///< the branch begins at the right bus
    std::array<std::size_t, 2> slots{}; ///< at the left and the right bus, from the top
    std::size_t lane_row{0}, lane{0};
};

struct Ways {
    /// Slots of a bar that are taken.
    struct Slots {
        std::set<std::size_t> left, right;
    };
    std::vector<Way> all;
    std::vector<Slots> slots;       ///< of each bus
    std::vector<std::size_t> lanes; ///< how many there are below each row
};

/// Of all branches whose ends are known. No two share a slot, and none runs through a cell that a bus has.
[[nodiscard]] Ways find_ways(Grid const& grid, std::vector<Cell> const& cells,
                             std::map<std::string, std::size_t> const& number);

} // namespace gridspace::diagram

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/diagram/grid.hpp"
#include "monitor/diagram/shapes.hpp"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::diagram {

struct Point {
    double x{0}, y{0};
};

/// A breaker or a current transformer on a branch.
struct Symbol {
    std::string name;
    bool is_ct{false};
    Point at;
    std::vector<std::string> tags; ///< relays that look at it
    std::vector<double> tags_x;    ///< middle of each tag below it; next to a branch that goes down they stand in a row
};

/// A branch: from its begin to its end, along horizontal and vertical pieces.
struct Route {
    Grid::Branch const* branch{nullptr};
    std::vector<Point> path;
    std::vector<Symbol> symbols;
    Point label;
    bool upright{false};                        ///< a tie between two bars of a column: names stand next to it
    std::array<Point, 2> bare{};                ///< a piece without symbols, from its begin on: there faults are shown
    [[nodiscard]] Point at(double share) const; ///< of that piece
};

struct Hanging {
    Grid::Device const* device{nullptr};
    Point at; ///< on the bar
    bool left{false};
};

struct Bar {
    Grid::Bus const* bus{nullptr};
    double x{0}, top{0}, bottom{0};
    bool tied{false}; ///< a branch comes from above: the label stands next to it
};

struct Layout {
    std::vector<Bar> bars;
    std::vector<Route> routes;
    std::vector<Hanging> devices;
    double width{0}, height{0};
};

/// Buses in columns and rows: those of the network file or, where a bus has none, by the distance from the first bus.
/// Branches run horizontally from bar to bar and turn in a track before the next column, so that nothing runs through
/// a bar, and no two labels share a place. `live`: there is room for values next to the labels.
[[nodiscard]] Layout lay_out(Grid const& grid, bool live);

} // namespace gridspace::diagram

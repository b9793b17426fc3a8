// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/diagram/grid.hpp"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::diagram {

// Lengths in the units of the drawing, which are pixels on a wide screen.
inline constexpr double kDeviceRow = 25, kStub = 14, kTagRow = 18, kFaultRow = 12, kValueRow = 12, kValueRoom = 64;

struct Point {
    double x{0}, y{0};
};

/// What hangs on a bus, as it is drawn: what is in no list is an arrow.
enum class DeviceShape { source, circle, store, arrow };
[[nodiscard]] DeviceShape shape_of(std::string_view kind);
/// From the end of its stub to its label; and what is kept free behind that for live values.
[[nodiscard]] double label_offset(DeviceShape shape);
[[nodiscard]] double room_of(DeviceShape shape);

/// How wide a text of 12 (a name) or 11 is at most, with the usual sans-serif fonts.
[[nodiscard]] double width_of(std::string_view text);

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

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/diagram/places.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace gridspace::diagram {
namespace {

using Spot = std::pair<double, double>; // x, y

std::vector<Spot> by_distance(Grid const& grid) {
    std::map<std::string, std::size_t> number;
    for (std::size_t b = 0; b < grid.buses.size(); ++b) {
        number.emplace(grid.buses[b].name, b);
    }
    std::vector<std::vector<std::size_t>> beside(grid.buses.size());
    for (Grid::Branch const& branch : grid.branches) {
        auto const from = number.find(branch.from), to = number.find(branch.to);
        if (from != number.end() && to != number.end()) {
            beside[from->second].push_back(to->second);
            beside[to->second].push_back(from->second);
        }
    }
    std::vector<Spot> out(grid.buses.size());
    std::vector<bool> found(grid.buses.size(), false);
    std::map<std::size_t, double> used; // rows of a column
    for (std::size_t root = 0; root < grid.buses.size(); ++root) {
        std::vector<std::size_t> front;
        if (!found[root]) {
            front.push_back(root);
            found[root] = true;
        }
        for (std::size_t x = 0; !front.empty(); ++x) {
            std::vector<std::size_t> next;
            for (std::size_t const bus : front) {
                out[bus] = {static_cast<double>(x), used[x]++};
                for (std::size_t const other : beside[bus]) {
                    if (!found[other]) {
                        found[other] = true;
                        next.push_back(other);
                    }
                }
            }
            front = std::move(next);
        }
    }
    return out;
}

} // namespace

std::vector<Cell> places(Grid const& grid) {
    bool const given = std::all_of(grid.buses.begin(), grid.buses.end(), [](Grid::Bus const& b) { return b.x && b.y; });
    std::vector<Spot> spots;
    for (Grid::Bus const& b : given ? grid.buses : std::vector<Grid::Bus>{}) {
        spots.emplace_back(*b.x, *b.y);
    }
    spots = given ? spots : by_distance(grid);
    std::set<Spot> taken;
    std::set<double> columns, rows;
    for (Spot& spot : spots) {
        while (!taken.insert(spot).second) {
            spot.second += 0.5; // two buses of one place stand below each other
        }
        columns.insert(spot.first);
        rows.insert(spot.second);
    }
    std::vector<Cell> out;
    auto const index = [](std::set<double> const& of, double value) {
        return static_cast<std::size_t>(std::distance(of.begin(), of.find(value)));
    };
    for (Spot const& spot : spots) {
        out.push_back({index(columns, spot.first), index(rows, spot.second)});
    }
    return out;
}

} // namespace gridspace::diagram

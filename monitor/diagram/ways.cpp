// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/diagram/ways.hpp"

#include <algorithm>

namespace gridspace::diagram {
namespace {

bool is_free(std::vector<Cell> const& cells, std::size_t row, std::size_t from_column, std::size_t to_column) {
    return std::none_of(cells.begin(), cells.end(),
                        [&](Cell const& c) { return c.row == row && c.column > from_column && c.column < to_column; });
}

std::size_t first_free(std::set<std::size_t> const& used, std::set<std::size_t> const* also = nullptr) {
    std::size_t slot = 0;
    while (used.contains(slot) || (also != nullptr && also->contains(slot))) {
        ++slot;
    }
    return slot;
}

/// Straight branches first: they leave both bars at one height. Then the others, in the order of where they go to.
void find_slots(Ways& ways, std::vector<Cell> const& cells) {
    std::vector<Way*> others;
    for (Way& way : ways.all) {
        if (way.kind == Way::Kind::straight) {
            auto &right = ways.slots[way.left].right, &left = ways.slots[way.right].left;
            way.slots[0] = way.slots[1] = first_free(right, &left);
            right.insert(way.slots[0]);
            left.insert(way.slots[0]);
        } else if (way.kind != Way::Kind::upright) {
            others.push_back(&way);
        }
    }
    auto const take = [&](std::size_t end) {
        std::stable_sort(others.begin(), others.end(), [&](Way const* a, Way const* b) {
            return cells[end == 0 ? a->right : a->left].row < cells[end == 0 ? b->right : b->left].row;
        });
        for (Way* way : others) {
            Ways::Slots& bar = ways.slots[end == 0 ? way->left : way->right];
            auto& used = end == 0 || way->kind == Way::Kind::loop ? bar.right : bar.left;
            way->slots[end] = first_free(used);
            used.insert(way->slots[end]);
        }
    };
    take(0);
    take(1);
}

} // namespace

Ways find_ways(Grid const& grid, std::vector<Cell> const& cells, std::map<std::string, std::size_t> const& number) {
    Ways out;
    out.slots.resize(cells.size());
    std::set<std::pair<std::size_t, std::size_t>> upright;
    for (Cell const& cell : cells) {
        out.lanes.resize(std::max(out.lanes.size(), cell.row + 1));
    }
    for (Grid::Branch const& branch : grid.branches) {
        auto const from = number.find(branch.from), to = number.find(branch.to);
        if (from == number.end() || to == number.end()) {
            continue;
        }
        Way way;
        way.branch = &branch;
        Cell const a = cells[from->second], b = cells[to->second];
        way.turned = a.column != b.column ? a.column > b.column : a.row > b.row;
        way.left = way.turned ? to->second : from->second;
        way.right = way.turned ? from->second : to->second;
        Cell const l = cells[way.left], r = cells[way.right];
        if (l.column == r.column) {
            bool const next = std::none_of(cells.begin(), cells.end(), [&](Cell const& c) {
                return c.column == l.column && c.row > l.row && c.row < r.row;
            });
            bool const first = next && way.left != way.right && upright.emplace(way.left, way.right).second;
            way.kind = first ? Way::Kind::upright : Way::Kind::loop;
        } else if (l.row == r.row && is_free(cells, l.row, l.column, r.column)) {
            way.kind = Way::Kind::straight;
        } else if (l.row != r.row && is_free(cells, r.row, l.column, r.column)) {
            way.kind = Way::Kind::turns;
        } else if (l.row != r.row && is_free(cells, l.row, l.column, r.column)) {
            way.kind = Way::Kind::late_turn;
        } else {
            way.kind = Way::Kind::lane;
            way.lane_row = std::min(l.row, r.row);
            way.lane = out.lanes[way.lane_row]++;
        }
        out.all.push_back(way);
    }
    find_slots(out, cells);
    return out;
}

} // namespace gridspace::diagram

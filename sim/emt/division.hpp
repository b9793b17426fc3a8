// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

namespace gridspace::sim::emt {

/// What waits for what in a solution, by place in the order of elimination.
struct EliminationTree {
    std::vector<int> order;   ///< the unknown at a place
    std::vector<int> parent;  ///< a later place; -1: none
    std::vector<double> work; ///< multiplications of an unknown
};

/// Unknowns by those who solve for them at the same time, and a rest that all of them wait for.
struct Division {
    int parts{1};
    std::vector<int> part; ///< by unknown; `parts`: the rest. Empty with one part
    [[nodiscard]] int of(int unknown) const { return part.empty() ? 0 : part[static_cast<std::size_t>(unknown)]; }
};

/// Divides among `parts` by whole subtrees of the elimination tree, which do not depend on each other; what is above
/// them is the rest. Parts of a network that travelling waves separate are trees of their own. Unknowns that are tied
/// come to one part, or one of them to the rest: an element lies between them. One part where there is too little work,
/// or no good division.
[[nodiscard]] Division divide(EliminationTree const& tree, std::vector<std::pair<int, int>> const& ties, int parts);

} // namespace gridspace::sim::emt

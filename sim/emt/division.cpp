// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/division.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

namespace gridspace::sim::emt {
namespace {

/// Multiplications for which two meetings of threads in a solution are not worth while.
constexpr double kLeastWork = 8000;
/// What an element's work at a node takes, in multiplications.
constexpr double kTieWork = 8;
/// Of the work of one, that two or more must not exceed.
constexpr double kWorthWhile = 0.85;
/// Subtrees of a part's share of the work, of half of that, and so on.
constexpr int kHalvings = 7;

int root_of(std::vector<int>& up, int i) {
    while (up[static_cast<std::size_t>(i)] != i) {
        int& above = up[static_cast<std::size_t>(i)];
        i = above = up[static_cast<std::size_t>(above)];
    }
    return i;
}

struct Candidate {
    double longest{0}; ///< work of the busiest part and of the rest, one after the other
    Division division;
};

/// Maximal subtrees with at most `limit` of work, those that are tied together, the largest first to who has least.
Candidate with_subtrees(EliminationTree const& tree, std::vector<double> const& own, std::vector<double> const& below,
                        std::vector<std::pair<int, int>> const& ties, double limit, int parts) {
    std::size_t const n = tree.order.size();
    std::vector<int> group(n, -1); // by unknown
    std::vector<int> at(n, -1);    // by place
    std::vector<int> up;
    Candidate out;
    for (std::size_t k = n; k-- > 0;) {
        if (below[k] > limit) {
            out.longest += own[k];
            continue;
        }
        int const above = tree.parent[k];
        if (above >= 0 && at[static_cast<std::size_t>(above)] >= 0) {
            at[k] = at[static_cast<std::size_t>(above)];
        } else {
            at[k] = static_cast<int>(up.size());
            up.push_back(at[k]);
        }
        group[static_cast<std::size_t>(tree.order[k])] = at[k];
    }
    for (auto const& [a, b] : ties) {
        int const ga = group[static_cast<std::size_t>(a)], gb = group[static_cast<std::size_t>(b)];
        if (ga >= 0 && gb >= 0) {
            int const ra = root_of(up, ga), rb = root_of(up, gb);
            up[static_cast<std::size_t>(std::max(ra, rb))] = std::min(ra, rb);
        }
    }
    std::vector<double> weight(up.size(), 0.0);
    for (std::size_t k = 0; k < n; ++k) {
        if (at[k] >= 0) {
            weight[static_cast<std::size_t>(root_of(up, at[k]))] += own[k];
        }
    }
    std::vector<int> by_weight(up.size()), part_of(up.size(), 0);
    std::iota(by_weight.begin(), by_weight.end(), 0);
    std::ranges::stable_sort(by_weight, std::greater{}, [&](int g) { return weight[static_cast<std::size_t>(g)]; });
    std::vector<double> load(static_cast<std::size_t>(parts), 0.0);
    for (int const g : by_weight) {
        auto const least = std::ranges::min_element(load);
        *least += weight[static_cast<std::size_t>(g)];
        part_of[static_cast<std::size_t>(g)] = static_cast<int>(least - load.begin());
    }
    out.longest += *std::ranges::max_element(load);
    out.division.parts = parts;
    out.division.part.assign(n, parts);
    for (std::size_t u = 0; u < n; ++u) {
        if (group[u] >= 0) {
            out.division.part[u] = part_of[static_cast<std::size_t>(root_of(up, group[u]))];
        }
    }
    return out;
}

} // namespace

Division divide(EliminationTree const& tree, std::vector<std::pair<int, int>> const& ties, int parts) {
    std::size_t const n = tree.order.size();
    std::vector<double> of_unknown(n, 0.0), own(n), below(n);
    for (auto const& [a, b] : ties) {
        of_unknown[static_cast<std::size_t>(a)] += kTieWork;
        of_unknown[static_cast<std::size_t>(b)] += kTieWork;
    }
    for (std::size_t k = 0; k < n; ++k) { // children come before their parents
        own[k] = tree.work[k] + of_unknown[static_cast<std::size_t>(tree.order[k])];
        below[k] += own[k];
        if (tree.parent[k] >= 0) {
            below[static_cast<std::size_t>(tree.parent[k])] += below[k];
        }
    }
    double const total = std::accumulate(own.begin(), own.end(), 0.0);
    if (parts < 2 || total < kLeastWork) {
        return {};
    }
    Candidate best{kWorthWhile * total, {}};
    double limit = total / parts;
    for (int i = 0; i < kHalvings; ++i, limit /= 2) {
        Candidate found = with_subtrees(tree, own, below, ties, limit, parts);
        if (found.longest < best.longest) {
            best = std::move(found);
        }
    }
    return std::move(best.division);
}

} // namespace gridspace::sim::emt

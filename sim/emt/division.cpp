// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/division.hpp"

#include <algorithm>
#include <numeric>

namespace gridspace::sim::emt {
namespace {

/// Multiplications for which two meetings of threads in a solution are not worth while.
constexpr double kLeastWork = 8000;
/// What an element's work at a node takes, in multiplications.
constexpr double kTieWork = 8;
/// What work of the rest costs: it is fetched from everybody, and each sum waits for the one before (measured).
constexpr double kRestWork = 2.5;
/// Of the work of one, that two or more must not exceed.
constexpr double kWorthWhile = 0.85;
/// How often a subtree is opened that lies across the border of two parts.
constexpr int kOpenings = 24;

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
    std::vector<std::size_t> across; ///< roots of the subtrees that lie most across the border of two parts
};

/// The subtrees below those places that are open, and together those that are tied.
Candidate with_subtrees(EliminationTree const& tree, std::vector<double> const& own, std::vector<bool> const& open,
                        std::vector<std::pair<int, int>> const& ties, int parts) {
    std::size_t const n = tree.order.size();
    std::vector<int> group(n, -1); // by unknown
    std::vector<int> at(n, -1);    // by place
    std::vector<int> up;
    Candidate out;
    for (std::size_t k = n; k-- > 0;) {
        if (open[k]) {
            out.longest += kRestWork * own[k];
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
    // One part after the other in the order of the unknowns, which is that of the network file: neighbours in memory
    // belong to one processor.
    std::vector<int> in_order, part_of(up.size(), 0);
    std::vector<bool> seen(up.size(), false);
    for (int const g : group) {
        if (g >= 0) {
            auto const root = static_cast<std::size_t>(root_of(up, g));
            if (!seen[root]) {
                seen[root] = true;
                in_order.push_back(static_cast<int>(root));
            }
        }
    }
    double const all = std::accumulate(weight.begin(), weight.end(), 0.0);
    std::vector<double> load(static_cast<std::size_t>(parts), 0.0);
    double before = 0, most_across = 0;
    int across = -1;
    for (int const g : in_order) {
        auto const root = static_cast<std::size_t>(g);
        auto const part = std::clamp(static_cast<int>((before + weight[root] / 2) / all * parts), 0, parts - 1);
        load[static_cast<std::size_t>(part)] += weight[root];
        part_of[root] = part;
        for (int border = 1; border < parts; ++border) {
            double const cut = all * border / parts, over = std::min(cut - before, before + weight[root] - cut);
            if (over > most_across) {
                most_across = over;
                across = g;
            }
        }
        before += weight[root];
    }
    for (std::size_t k = 0; across >= 0 && k < n; ++k) {
        int const above = tree.parent[k];
        bool const is_root = at[k] >= 0 && (above < 0 || at[static_cast<std::size_t>(above)] < 0);
        if (is_root && root_of(up, at[k]) == across) {
            out.across.push_back(k);
        }
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
    std::vector<bool> open(n);
    for (std::size_t k = 0; k < n; ++k) {
        open[k] = below[k] > total / parts;
    }
    Candidate best{kWorthWhile * total, {}, {}};
    for (int i = 0; i < kOpenings; ++i) {
        Candidate found = with_subtrees(tree, own, open, ties, parts);
        for (std::size_t const k : found.across) {
            open[k] = true;
        }
        bool const last = found.across.empty();
        if (found.longest < best.longest) {
            best = std::move(found);
        }
        if (last) {
            break;
        }
    }
    return std::move(best.division);
}

} // namespace gridspace::sim::emt

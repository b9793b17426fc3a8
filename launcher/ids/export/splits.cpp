// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/export/splits.hpp"

#include "common/random.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace gridspace::dataset {
namespace {

/// A number for each run; the same for runs that belong together.
std::vector<std::size_t> joined(std::vector<std::vector<std::string>> const& groups) {
    std::vector<std::size_t> parent(groups.size());
    std::iota(parent.begin(), parent.end(), std::size_t{0});
    auto const root = [&](std::size_t i) {
        while (parent[i] != i) {
            i = parent[i];
        }
        return i;
    };
    std::map<std::string, std::size_t> first;
    for (std::size_t i = 0; i < groups.size(); ++i) {
        for (std::string const& group : groups[i]) {
            std::size_t const a = root(first.try_emplace(group, i).first->second), b = root(i);
            parent[std::max(a, b)] = std::min(a, b);
        }
    }
    for (std::size_t i = 0; i < groups.size(); ++i) {
        parent[i] = root(i);
    }
    return parent;
}

} // namespace

std::vector<std::string> split(std::vector<std::vector<std::string>> const& groups, std::vector<std::string> const& ids,
                               std::uint64_t seed) {
    std::vector<std::size_t> const of_run = joined(groups);
    std::map<std::size_t, std::string> names; ///< the smallest of a group's names, or of its runs
    for (std::size_t i = 0; i < groups.size(); ++i) {
        for (std::string const& name : groups[i].empty() ? std::vector<std::string>{"run " + ids[i]} : groups[i]) {
            auto const [at, is_new] = names.try_emplace(of_run[i], name);
            at->second = std::min(at->second, name);
        }
    }
    std::vector<std::pair<std::string, std::size_t>> order;
    for (auto const& [group, name] : names) {
        order.emplace_back(name, group);
    }
    std::sort(order.begin(), order.end());
    Random random{seed, "splits"};
    for (std::size_t i = order.size(); i > 1; --i) {
        std::swap(order[i - 1], order[random.below(i)]);
    }
    auto const count = order.size();
    auto const fifth =
        std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(0.2 * static_cast<double>(count))));
    std::size_t const test = count >= 2 ? fifth : 0, validation = count >= 3 ? fifth : 0;
    std::map<std::size_t, char const*> part;
    for (std::size_t i = 0; i < count; ++i) {
        part[order[i].second] = i < test ? "test" : i < test + validation ? "validation" : "train";
    }
    std::vector<std::string> out;
    for (std::size_t const group : of_run) {
        out.emplace_back(part.at(group));
    }
    return out;
}

} // namespace gridspace::dataset

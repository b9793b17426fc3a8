// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/diagram/symbols.hpp"

#include <algorithm>

namespace gridspace::diagram {
namespace {

/// The relays that look at the transformer, by name, each with its functions.
std::vector<std::string> tags_of(Grid const& grid, std::string const& ct) {
    std::vector<std::string> out;
    for (Grid::Relay const& relay : grid.relays) {
        if (std::any_of(relay.cts.begin(), relay.cts.end(), [&](config::Ref const& own) { return own.name == ct; })) {
            std::string tag = relay.name;
            for (config::Ref const& function : relay.functions) {
                tag += " " + function.name;
            }
            out.push_back(std::move(tag));
        }
    }
    return out;
}

} // namespace

double add_symbols(Grid const& grid, std::string_view word, std::size_t end, Route& route) {
    double x = 10, tag_x = 6;
    auto const add = [&](std::string const& name, bool is_ct) {
        Symbol s{name, is_ct, {}, {}, {}};
        double const half = std::max(width_of(name) / 2, 8.0);
        s.at.x = x + half;
        x += 2 * half + 6;
        if (is_ct) {
            s.tags = tags_of(grid, name);
        }
        for (std::string const& tag : s.tags) {
            s.tags_x.push_back(std::max(s.at.x, tag_x + (width_of(tag) / 2 + 5)));
        }
        for (std::size_t t = 0; t < s.tags.size(); ++t) {
            tag_x = std::max(tag_x, s.tags_x[t] + width_of(s.tags[t]) / 2 + 9);
        }
        s.at.y = static_cast<double>(end);
        route.symbols.push_back(std::move(s));
    };
    for (Grid::Breaker const& breaker : grid.breakers) {
        if (breaker.line == route.branch->name && breaker.end == word) {
            add(breaker.name, false);
        }
    }
    for (Grid::Ct const& ct : grid.cts) {
        if (ct.line == route.branch->name && ct.end == word) {
            add(ct.name, true);
        }
    }
    return x > 10 ? std::max(x, tag_x) : 0;
}

} // namespace gridspace::diagram

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/diagram/grid.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::diagram {

struct Look {
    /// The last value of a signal: positions of breakers and fuses, states of charge. Nothing: there is none.
    std::function<std::optional<double>(std::string const&)> last;
    /// For a page that dresses it: places for values behind the labels, faults that are shown when they come.
    bool live{false};
};

/// A label, and what it takes at most.
struct LabelBox {
    std::string text;
    double left{0}, top{0}, right{0}, bottom{0};
};

struct Picture {
    std::string svg; ///< stands alone; elements are groups with a class (bus, branch, breaker, ct, device, fault,
                     ///< relay) and their name in `data-name`
    std::vector<LabelBox> labels;
};

/// The one-line diagram of a grid: dark or light as its surroundings are.
[[nodiscard]] Picture one_line(Grid const& grid, Look const& look);

} // namespace gridspace::diagram

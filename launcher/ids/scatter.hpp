// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace gridspace::cli {

/// A plot of labelled points, as a drawing that stands alone.
struct Scatter {
    std::string title, x_label, y_label;
    bool x_log{false}, y_log{false};
    struct Point {
        double x{0}, y{0};
        std::string label;
        int group{0};
    };
    std::vector<Point> points;
    bool connect{false}; ///< a line through the points of each group
};
[[nodiscard]] std::string to_svg(Scatter const& plot);

} // namespace gridspace::cli

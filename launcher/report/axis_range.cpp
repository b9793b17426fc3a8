// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/axis_range.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace gridspace::launcher {

double on_axis(Figure const& figure, double value) {
    if (!figure.log_y) {
        return value;
    }
    return value > 0 ? std::log10(value) : figure.x_label.empty() ? std::nan("") : std::log10(0.5);
}

AxisRange range_of(Figure const& figure, bool right) {
    AxisRange r{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    auto const include = [&](double v) {
        if (std::isfinite(v)) {
            r.low = std::min(r.low, v);
            r.high = std::max(r.high, v);
        }
    };
    for (Figure::Series const& s : figure.series) {
        if (s.right_axis != right) {
            continue;
        }
        if (s.bars) {
            include(0);
        }
        for (std::size_t i = 0; i < s.values.size(); ++i) { // what a line holds at the begin is drawn too
            bool const begun =
                s.path || i + 1 >= s.values.size() || static_cast<double>(s.times_ns[i + 1]) / 1e9 >= figure.from_s;
            if (begun && (s.path || static_cast<double>(s.times_ns[i]) / 1e9 <= figure.to_s)) {
                include(on_axis(figure, s.values[i]));
            }
        }
    }
    for (Figure::Line const& line : right ? std::vector<Figure::Line>{} : figure.lines) {
        include(on_axis(figure, line.value));
    }
    for (Figure::Band const& band : right ? std::vector<Figure::Band>{} : figure.bands) {
        include(on_axis(figure, band.low));
        include(on_axis(figure, band.high));
    }
    if (!(r.low <= r.high)) {
        return {0, 1};
    }
    // What differs by rounding only is constant: its ticks would not differ at all.
    bool const varies = r.high - r.low > 1e-12 * std::max(std::abs(r.low), std::abs(r.high));
    double const pad = varies ? 0.05 * (r.high - r.low) : std::max(1e-6, 0.05 * std::abs(r.high));
    return {r.low - pad, r.high + pad};
}

} // namespace gridspace::launcher

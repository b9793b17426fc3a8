// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/spread.hpp"

#include "common/nearest_rank.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::launcher {

Spread spread_of(std::vector<double> values) {
    Spread out;
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    out.count = values.size();
    if (values.empty()) {
        return out;
    }
    std::sort(values.begin(), values.end());
    for (double const v : values) {
        out.mean += v / static_cast<double>(values.size());
    }
    constexpr double kNanosecondMs = 1e-6; // what the arithmetic of doubles may lose
    out.below_zero = static_cast<std::size_t>(
        std::count_if(values.begin(), values.end(), [](double v) { return v < -kNanosecondMs; }));
    out.min = values.front();
    out.p50 = nearest_rank(values, 0.5);
    out.p99 = nearest_rank(values, 0.99);
    out.p999 = nearest_rank(values, 0.999);
    out.max = values.back();
    return out;
}

} // namespace gridspace::launcher

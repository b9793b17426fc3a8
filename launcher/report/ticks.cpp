// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/ticks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gridspace::launcher {
namespace {

/// The least round number that is not below `raw`. Hours are counted as clocks and calendars do, and so are minutes.
double round_step(double raw, std::string_view unit) {
    std::vector<double> const clock = unit == "h"     ? std::vector<double>{1, 2, 3, 6, 12, 24, 48, 72, 168}
                                      : unit == "min" ? std::vector<double>{1, 2, 5, 10, 15, 30, 60}
                                                      : std::vector<double>{};
    if (!clock.empty() && raw > 0.5 && raw <= clock.back()) {
        return *std::lower_bound(clock.begin(), clock.end(), raw);
    }
    double const magnitude = std::pow(10, std::floor(std::log10(raw)));
    for (double const m : {1.0, 2.0, 2.5, 5.0}) {
        if (m * magnitude >= raw) {
            return m * magnitude;
        }
    }
    return 10 * magnitude;
}

} // namespace

std::vector<double> ticks(double low, double high, int count, std::string_view unit) {
    double const step = round_step((high - low) / count, unit);
    std::vector<double> out;
    double before = -std::numeric_limits<double>::infinity(); // of values so large, a step may make no difference
    for (double v = std::ceil(low / step) * step; v <= high + 1e-9 * step && v > before; before = v, v += step) {
        out.push_back(std::abs(v) < 1e-12 * step ? 0 : v);
    }
    return out;
}

std::vector<double> decades(double low, double high) {
    std::vector<double> out;
    for (double decade = std::floor(low); decade <= high; ++decade) {
        for (double const times : {1.0, 2.0, 5.0}) {
            double const place = decade + std::log10(times);
            if (place >= low - 1e-9 && place <= high + 1e-9 && (times == 1 || high - low < 2.5)) {
                out.push_back(times * std::pow(10, decade));
            }
        }
    }
    return out;
}

} // namespace gridspace::launcher

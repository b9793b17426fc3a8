// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "launcher/judge/expectation.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace::launcher {

bool Expectation::Band::contains(double v) const {
    bool const above_low = !low || (low_open ? v > *low : v >= *low);
    bool const below_high = !high || (high_open ? v < *high : v <= *high);
    return above_low && below_high; // NaN is in no band
}

std::string Expectation::Band::to_string() const {
    if (low && high) {
        return *low == *high ? shortest(*low) : fmt::format("{} .. {}", shortest(*low), shortest(*high));
    }
    if (low) {
        return fmt::format("{} {}", low_open ? ">" : ">=", shortest(*low));
    }
    return high ? fmt::format("{} {}", high_open ? "<" : "<=", shortest(*high)) : "";
}

double Expectation::unit_s() const {
    return unit == "h" ? 3600 : unit == "min" ? 60 : unit == "ms" ? 1e-3 : 1;
}

Expectation::Band Expectation::band() const {
    Band b;
    if (is) {
        // 4.2 - 0.1 is 4.1000000000000005; what the user meant has few digits.
        auto const tidy = [](double v) { return std::round(v * 1e12) / 1e12; };
        b.low = tidy(*is - tolerance.value_or(0));
        b.high = tidy(*is + tolerance.value_or(0));
    }
    if (between.size() == 2) {
        b.low = between[0];
        b.high = between[1];
    }
    if (at_least) {
        b.low = *at_least;
    }
    if (at_most) {
        b.high = *at_most;
    }
    if (above) {
        b.low = *above;
        b.low_open = true;
    }
    if (below) {
        b.high = *below;
        b.high_open = true;
    }
    return b;
}

} // namespace gridspace::launcher

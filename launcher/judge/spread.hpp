// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace gridspace::launcher {

/// Of a set of delays or intervals, milliseconds. Percentiles by nearest rank.
struct Spread {
    std::size_t count{0};
    double min{0}, mean{0}, p50{0}, p99{0}, p999{0}, max{0};
    std::size_t below_zero{0};
    /// Nothing arrives before it was sent: below zero, the clocks of the two ends are not one, and no figure means
    /// anything.
    [[nodiscard]] bool measurable() const { return below_zero == 0; }
};
[[nodiscard]] Spread spread_of(std::vector<double> values);

} // namespace gridspace::launcher

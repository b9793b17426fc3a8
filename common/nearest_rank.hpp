// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace gridspace {

/// The nearest-rank percentile of sorted values: the least of which at least the share (0 to 1) of all are not greater.
/// None: 0.
[[nodiscard]] inline double nearest_rank(std::span<double const> sorted, double share) {
    constexpr double kRounding = 1e-9; // 0.07 times 100 is more than 7
    auto const rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size()) - kRounding));
    return sorted.empty() ? 0 : sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

} // namespace gridspace

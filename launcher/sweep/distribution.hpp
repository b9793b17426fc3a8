// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

namespace gridspace::launcher {

/// What a parameter is drawn from.
struct Distribution {
    enum class Kind { uniform, log_uniform, normal, triangular } kind{Kind::uniform};
    double low{-std::numeric_limits<double>::infinity()}; ///< bounds; of a normal distribution, where it is cut off
    double high{std::numeric_limits<double>::infinity()};
    double mode{0};               ///< of a triangular one
    double mean{0}, deviation{1}; ///< of a normal one
};

/// Of a normal distribution: the share of draws between the bounds.
[[nodiscard]] double normal_share(Distribution const& distribution);

/// The value below which the share `u` (0 < u < 1) of all draws lies: the inverse of the distribution function.
[[nodiscard]] double quantile(Distribution const& distribution, double u);

} // namespace gridspace::launcher

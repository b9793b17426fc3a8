// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/circuit/pole_sum.hpp"

#include <complex>
#include <vector>

namespace gridspace::sim {

/// A function of frequency by its samples.
struct FrequencyResponse {
    std::vector<double> omega; ///< rad/s
    std::vector<std::complex<double>> value;
    std::vector<double> weight; ///< an error of 1 / weight counts as 1
};

/// The rational function with `count` real poles that is nearest to the samples, least squares: vector fitting, poles
/// on the right turned to the left [Gustavsen and Semlyen, IEEE Trans. Power Delivery 14(3), 1999]. Samples from the
/// `exact`-th on do not move poles; the function goes through them.
[[nodiscard]] emt::PoleSum vector_fit(FrequencyResponse const& samples, std::size_t exact, int count, int rounds);

/// Root mean square of weight times error over the first `count` samples.
[[nodiscard]] double fit_error(FrequencyResponse const& samples, std::size_t count, emt::PoleSum const& fit);

} // namespace gridspace::sim

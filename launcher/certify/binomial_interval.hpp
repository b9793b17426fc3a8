// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace gridspace::launcher {

/// A share of successes and the interval in which the true one lies.
struct Proportion {
    std::size_t successes{0}, of{0};
    double estimate{0}, low{0}, high{1};
};

/// The interval of Clopper and Pearson (Biometrika 26 (1934) 404): exact, it covers the true share with at least
/// `confidence`, for every number of trials. None at all: 0 to 1.
[[nodiscard]] Proportion clopper_pearson(std::size_t successes, std::size_t of, double confidence);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace gridspace::ids {

/// A share with its 95 % confidence interval; percent.
struct Share {
    std::uint64_t count{0}, of{0};
    double percent{0}, low_percent{0}, high_percent{0};
};

/// `count` of `of`, with Wilson's interval; with none at all, the upper bound is the "rule of three" (3 / of). Without
/// anything to count, the interval is 0 to 100.
[[nodiscard]] Share share_of(std::uint64_t count, std::uint64_t of);

} // namespace gridspace::ids

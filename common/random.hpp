// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace gridspace {

/// Seeded random numbers with the same bits everywhere (xoshiro256**; the standard library's distributions differ
/// between vendors). Streams of different names or numbers under one seed do not share values.
class Random {
  public:
    explicit Random(std::uint64_t seed, std::uint64_t stream = 0);
    Random(std::uint64_t seed, std::string_view stream_name);

    [[nodiscard]] std::uint64_t next();
    [[nodiscard]] double uniform();                        ///< in [0, 1)
    [[nodiscard]] double uniform(double low, double high); ///< in [low, high)
    [[nodiscard]] double normal();                         ///< mean 0, standard deviation 1
    [[nodiscard]] std::uint64_t below(std::uint64_t n);    ///< 0 .. n-1, n >= 1, without bias
    [[nodiscard]] bool chance(double share) { return uniform() < share; }

  private:
    std::array<std::uint64_t, 4> state_{};
    double spare_{0};
    bool has_spare_{false};
};

} // namespace gridspace

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace gridspace {

/// How late somebody was for instants that follow each other at a fixed period: counted by classes, so that a run of
/// any length takes the same memory and adding allocates nothing. A class is an eighth of its octave wide: a percentile
/// is its upper end, at most 12.5 % too large. The worst and the count beyond a period are exact.
class Lateness {
  public:
    explicit Lateness(std::chrono::nanoseconds period) : period_{period} {}

    /// Negative: too early, which counts as not late.
    void add(std::chrono::nanoseconds late);

    struct Summary {
        double period_us{0};
        std::uint64_t instants{0}, later_than_a_period{0};
        double p50_us{0}, p99_us{0}, p999_us{0}, worst_us{0};
    };
    [[nodiscard]] Summary summary() const;

  private:
    static constexpr std::size_t kParts = 8; ///< of an octave
    [[nodiscard]] static std::size_t class_of(std::uint64_t ns);
    [[nodiscard]] double percentile_us(double share) const;

    std::chrono::nanoseconds period_, worst_{0};
    std::uint64_t instants_{0}, later_than_a_period_{0};
    std::array<std::uint64_t, 64 * kParts> counts_{};
};

} // namespace gridspace

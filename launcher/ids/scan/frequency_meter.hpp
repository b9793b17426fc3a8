// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/nearest_rank.hpp"

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace gridspace::scan {

/// How long the cycles of a current are, in samples.
struct Cycles {
    double median{0};
    bool steady{false}; ///< half of them are within 5 % of it: forged samples make cycles, but hardly equal ones
};

/// Measures them between zero crossings from below. A crossing counts when the current has been below minus a tenth of
/// its peak since the last one: noise makes none.
class FrequencyMeter {
  public:
    void add(std::int64_t index, double value) {
        if (!std::isfinite(value)) {
            return;
        }
        peak_ = std::fmax(peak_ * kForget, std::fabs(value));
        armed_ = armed_ || value < -0.1 * peak_;
        if (armed_ && value >= 0) {
            armed_ = false;
            double const at = static_cast<double>(index) - (value > last_ ? value / (value - last_) : 0);
            if (crossed_ && cycles_.size() < kMost) {
                cycles_.push_back(at - newest_);
            }
            crossed_ = true;
            newest_ = at;
        }
        last_ = value;
    }
    /// Nothing before three whole cycles.
    [[nodiscard]] std::optional<Cycles> cycles() const {
        if (cycles_.size() < 3) {
            return std::nullopt;
        }
        std::vector<double> sorted = cycles_;
        std::sort(sorted.begin(), sorted.end());
        double const median = nearest_rank(sorted, 0.5), low = nearest_rank(sorted, 0.25),
                     high = nearest_rank(sorted, 0.75);
        return Cycles{median, low >= 0.95 * median && high <= 1.05 * median};
    }

  private:
    static constexpr double kForget = 0.999; ///< half in 700 samples
    static constexpr std::size_t kMost = 4096;
    double peak_{0}, last_{0}, newest_{0};
    bool armed_{false}, crossed_{false};
    std::vector<double> cycles_;
};

} // namespace gridspace::scan

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace gridspace::iec61850 {

/// Times between the frames of a stream, and its rate as the slope of the counter against time. No memory beyond
/// itself.
class ArrivalStatistics {
  public:
    /// Sample `index` arrived. Samples of one frame have the same time and count as one arrival.
    void add(std::int64_t index, std::int64_t now_ns) noexcept {
        if (count_ == 0) {
            first_index_ = index;
            first_ns_ = now_ns;
        } else {
            std::int64_t const gap = now_ns - last_ns_;
            if (gap == 0) {
                last_index_ = index;
                // The slope is between the last samples of two frames: those of the first were all there at its time.
                first_index_ = count_ == 1 ? index : first_index_;
                return;
            }
            if (gap < 0) {
                first_ns_ += gap; // the clock was set back: this step is left out of the slope
                first_index_ += index - last_index_;
            } else {
                shortest_ns_ = shortest_ns_ == 0 ? gap : std::min(shortest_ns_, gap);
                longest_ns_ = std::max(longest_ns_, gap);
                ++histogram_[bucket(gap)];
            }
        }
        last_index_ = index;
        last_ns_ = now_ns;
        ++count_;
    }
    void clear() noexcept { *this = {}; }

    [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
    [[nodiscard]] std::int64_t shortest_ns() const noexcept { return shortest_ns_; }
    [[nodiscard]] std::int64_t longest_ns() const noexcept { return longest_ns_; }
    [[nodiscard]] std::int64_t last_ns() const noexcept { return last_ns_; }
    [[nodiscard]] std::int64_t span_ns() const noexcept { return last_ns_ - first_ns_; }
    /// Samples per second between the first and the last arrival; 0 with fewer than two.
    [[nodiscard]] double rate_hz() const noexcept {
        return last_ns_ > first_ns_
                   ? static_cast<double>(last_index_ - first_index_) * 1e9 / static_cast<double>(last_ns_ - first_ns_)
                   : 0.0;
    }
    /// The same if the sample after the last one arrives at `now_ns`; 0 before the first.
    [[nodiscard]] double rate_hz_with_next(std::int64_t now_ns) const noexcept {
        return count_ > 0 && now_ns > first_ns_
                   ? static_cast<double>(last_index_ + 1 - first_index_) * 1e9 / static_cast<double>(now_ns - first_ns_)
                   : 0.0;
    }
    /// Times between arrivals by powers of two: bucket k holds [2^k, 2^(k+1)) ns.
    [[nodiscard]] std::array<std::uint64_t, 40> const& histogram() const noexcept { return histogram_; }

  private:
    [[nodiscard]] static std::size_t bucket(std::int64_t ns) noexcept {
        std::size_t k = 0;
        for (auto v = static_cast<std::uint64_t>(std::max<std::int64_t>(ns, 1)); v > 1 && k < 39; v >>= 1U) {
            ++k;
        }
        return k;
    }

    std::uint64_t count_{0};
    std::int64_t first_index_{0}, last_index_{0}, first_ns_{0}, last_ns_{0}, shortest_ns_{0}, longest_ns_{0};
    std::array<std::uint64_t, 40> histogram_{};
};

} // namespace gridspace::iec61850

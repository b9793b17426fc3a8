// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <ctime>

namespace gridspace {

/// Processor time of this thread: what something costs, whoever else wants the processor meanwhile. A system call.
[[nodiscard]] inline std::int64_t processor_time_ns() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return t.tv_sec * 1'000'000'000LL + t.tv_nsec;
}

/// How long something took that is done often: in classes of 0.1 us up to 400 us, and the longest. No allocation.
class DurationHistogram {
  public:
    void add(std::int64_t ns) {
        ns = std::max<std::int64_t>(ns, 0);
        ++counts_[std::min(static_cast<std::size_t>(ns) / kWidthNs, counts_.size() - 1)];
        ++count_;
        longest_ns_ = std::max(longest_ns_, ns);
    }
    [[nodiscard]] std::uint64_t count() const { return count_; }
    [[nodiscard]] double longest_us() const { return static_cast<double>(longest_ns_) / 1e3; }
    /// Nearest-rank percentile, rounded up to the width of a class; 0 when there is none.
    [[nodiscard]] double percentile_us(double share) const {
        std::uint64_t seen = 0;
        for (std::size_t i = 0; i + 1 < counts_.size(); ++i) {
            seen += counts_[i];
            if (seen > 0 && static_cast<double>(seen) >= share * static_cast<double>(count_)) {
                return std::min(static_cast<double>((i + 1) * kWidthNs) / 1e3, longest_us());
            }
        }
        return longest_us();
    }

  private:
    static constexpr std::size_t kWidthNs = 100;
    std::array<std::uint32_t, 4001> counts_{};
    std::uint64_t count_{0};
    std::int64_t longest_ns_{0};
};

} // namespace gridspace

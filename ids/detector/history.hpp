// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cassert>
#include <vector>

namespace gridspace::ids {

/// The last `size` samples of three phases, phase by phase in one piece and oldest first, as a forecaster reads them.
class History {
  public:
    explicit History(int size) : size_{size}, samples_(3 * static_cast<std::size_t>(size)) { assert(size > 0); }

    void push(double a, double b, double c) {
        double const next[3] = {a, b, c};
        auto const n = static_cast<std::size_t>(size_);
        for (std::size_t p = 0; p < 3; ++p) {
            double* const phase = &samples_[p * n];
            std::copy(phase + 1, phase + n, phase);
            phase[n - 1] = next[p];
        }
        filled_ = std::min(filled_ + 1, size_);
    }
    /// Makes phase `p` the same as that of another history of the same size.
    void copy_phase(History const& other, std::size_t p) {
        auto const n = static_cast<std::ptrdiff_t>(size_);
        std::copy_n(other.samples_.begin() + static_cast<std::ptrdiff_t>(p) * n, n,
                    samples_.begin() + static_cast<std::ptrdiff_t>(p) * n);
    }
    void clear() { filled_ = 0; }
    [[nodiscard]] bool full() const { return filled_ == size_; }
    [[nodiscard]] bool empty() const { return filled_ == 0; }
    [[nodiscard]] double const* phase(std::size_t p) const { return &samples_[p * static_cast<std::size_t>(size_)]; }
    [[nodiscard]] double newest(std::size_t p) const { return samples_[(p + 1) * static_cast<std::size_t>(size_) - 1]; }

  private:
    int size_, filled_{0};
    std::vector<double> samples_;
};

/// The largest magnitude of the last `size` values; constant amortised time, fixed memory.
class RunningPeak {
  public:
    explicit RunningPeak(int size) : size_{size}, ring_(static_cast<std::size_t>(size) + 1) {}

    void push(double value) {
        value = value < 0 ? -value : value;
        while (count_ > 0 && entry(count_ - 1).value <= value) {
            --count_;
        }
        entry(count_++) = {value, ++now_};
        if (entry(0).time + size_ <= now_) {
            first_ = (first_ + 1) % ring_.size();
            --count_;
        }
    }
    void clear() { count_ = 0; }
    [[nodiscard]] double value() const { return count_ == 0 ? 0 : ring_[first_].value; }

  private:
    struct Entry {
        double value{0};
        long long time{0};
    };
    Entry& entry(std::size_t i) { return ring_[(first_ + i) % ring_.size()]; }
    int size_;
    std::vector<Entry> ring_; ///< values that can still become the largest, decreasing
    std::size_t first_{0}, count_{0};
    long long now_{0};
};

} // namespace gridspace::ids

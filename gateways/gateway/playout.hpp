// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace gridspace::gateways {

/// When a merging unit sends a sample in real time: a buffer after the instant at which it was taken. Pure; times are
/// nanoseconds of the monotonic clock.
class Playout {
  public:
    Playout(double rate_hz, double buffer_s)
        : period_ns_{1e9 / rate_hz}, buffer_ns_{std::llround(buffer_s * 1e9)},
          round_{std::max<std::int64_t>(1, std::llround(rate_hz))} {}

    /// The first sample came. `zero_ns`: when simulated time was 0; nothing where that is not known. A clock that is
    /// behind the simulator's must not hold samples back: they wait no longer than a buffer after their arrival.
    void begin(std::int64_t index, std::int64_t arrived_ns, std::optional<std::int64_t> zero_ns) {
        std::int64_t const by_arrival = arrived_ns - span(index);
        origin_ns_ = buffer_ns_ + (zero_ns ? std::min(*zero_ns, by_arrival) : by_arrival);
    }
    [[nodiscard]] std::int64_t due(std::int64_t index) const { return origin_ns_ + span(index); }
    /// The newest sample that is due now.
    [[nodiscard]] std::int64_t index_at(std::int64_t now_ns) const {
        auto index = static_cast<std::int64_t>(std::floor(static_cast<double>(now_ns - origin_ns_) / period_ns_));
        while (due(index + 1) <= now_ns) {
            ++index;
        }
        while (due(index) > now_ns) {
            --index;
        }
        return index;
    }

    /// A sample was not there when it was due, and came so much later. Samples that come so late again and again (a
    /// slow machine, a clock that is ahead) would leave in bursts: then all leave later, by what the latest of a second
    /// needs.
    void came_late(std::int64_t late_ns) {
        ++late_;
        worst_ns_ = std::max(worst_ns_, late_ns);
    }
    /// A slot has passed; true when the schedule was put back.
    bool slot() {
        if (++slots_ < round_) {
            return false;
        }
        bool const often = late_ * kOften > round_;
        origin_ns_ += often ? std::min(worst_ns_, kMostNs) : 0;
        slots_ = late_ = worst_ns_ = 0;
        return often;
    }

  private:
    static constexpr std::int64_t kOften = 16; ///< one slot in so many
    static constexpr std::int64_t kMostNs = 20'000'000;
    [[nodiscard]] std::int64_t span(std::int64_t index) const {
        return std::llround(static_cast<double>(index) * period_ns_);
    }
    double period_ns_;
    std::int64_t buffer_ns_, round_;
    std::int64_t origin_ns_{0}, slots_{0}, late_{0}, worst_ns_{0};
};

} // namespace gridspace::gateways

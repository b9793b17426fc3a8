// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/functions/phasor.hpp"

#include <vector>

namespace gridspace::relay {

/// The positive-sequence voltage of two cycles ago, turned on by the frequency since then: in a fault it still is what
/// it was before. Where the voltage has collapsed (below `minimum_v`) the last one is turned on for `hold_samples`
/// more. No allocation after construction.
class PolarisingMemory {
  public:
    PolarisingMemory(int samples_per_cycle, double minimum_v, std::int64_t hold_samples)
        : ring_(2 * static_cast<std::size_t>(samples_per_cycle)), minimum_v_{minimum_v}, hold_samples_{hold_samples} {}

    /// `turn`: by which a phasor turns in a sample, `turn_two_cycles`: in two nominal cycles; at the present frequency.
    void push(Complex positive, Complex turn, Complex turn_two_cycles) {
        Complex const before = ring_[next_];
        ring_[next_] = positive;
        next_ = next_ + 1 == ring_.size() ? 0 : next_ + 1;
        if (filled_ < ring_.size()) {
            ++filled_;
            return;
        }
        if (magnitude(positive) >= minimum_v_ && magnitude(before) >= minimum_v_) {
            voltage_ = before * turn_two_cycles;
            held_ = 0;
        } else if (held_ < hold_samples_) {
            voltage_ *= turn;
            ++held_;
        } else {
            voltage_ = 0;
        }
    }
    void clear() {
        filled_ = 0;
        voltage_ = 0;
    }
    /// 0 where nothing is remembered.
    [[nodiscard]] Complex voltage() const { return voltage_; }
    [[nodiscard]] bool has_voltage() const { return magnitude(voltage_) > 0; }

  private:
    std::vector<Complex> ring_;
    double minimum_v_;
    std::int64_t hold_samples_;
    std::size_t next_{0}, filled_{0};
    std::int64_t held_{0};
    Complex voltage_{};
};

} // namespace gridspace::relay

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/line_relay.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace gridspace::relay {

/// Keeps the waveforms around a trip (a disturbance recorder): `before` samples up to and including the trigger and
/// `after` samples behind it. Fixed memory. A trigger while one is being kept is counted, not taken.
class WaveformWindow {
  public:
    struct Row {
        std::int64_t index{0};
        Abc from_a{}, to_a{}, differential_a{};
        BlockReasons blocked{0};
        bool from_present{false}, to_present{false}, pickup{false}, trip{false};
    };
    WaveformWindow(std::size_t before, std::size_t after) : rows_(before + after), before_{before}, after_{after} {}

    /// Takes one sample and what the relay made of it. True when a window has just been completed.
    bool push(LineSample const& sample, RelayOutput const& output) {
        if (rows_.empty() || complete_) {
            return false;
        }
        rows_[next_] = {sample.index,   sample.from.i_a,     sample.to.i_a,     output.values.differential_a,
                        output.blocked, sample.from.present, sample.to.present, output.pickup,
                        output.trip};
        next_ = next_ + 1 == rows_.size() ? 0 : next_ + 1;
        count_ = count_ < rows_.size() ? count_ + 1 : count_;
        if (remaining_ > 0 && --remaining_ == 0) {
            complete_ = true;
        }
        return complete_;
    }
    /// Call before push() of the sample that triggers.
    void trigger() {
        if (remaining_ > 0 || complete_) {
            ++missed_;
            return;
        }
        remaining_ = after_ + 1;
    }
    /// Calls `take(Row const&)` oldest first, then starts to listen again.
    template <class Take>
    void drain(Take&& take) {
        std::size_t const wanted = std::min(count_, before_ + after_);
        for (std::size_t i = 0; i < wanted; ++i) {
            take(rows_[(next_ + rows_.size() - wanted + i) % rows_.size()]);
        }
        complete_ = false;
        remaining_ = 0;
    }
    [[nodiscard]] bool complete() const { return complete_; }
    [[nodiscard]] std::uint64_t missed() const { return missed_; }

  private:
    std::vector<Row> rows_;
    std::size_t before_, after_, next_{0}, count_{0};
    std::size_t remaining_{0}; ///< samples to come; 0: waiting for a trigger
    bool complete_{false};
    std::uint64_t missed_{0};
};

} // namespace gridspace::relay

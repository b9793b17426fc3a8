// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/sv_layout.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace gridspace::wire {

/// What `wire sv-pub` sends: balanced sinusoids. Members whose names differ in one letter only (Ia Ib Ic, Va Vb Vc) are
/// phases a, b, c of one quantity, the one with n (In) is their sum. Other numbers are phases a, b, c in their order.
/// Qualities are good (zero).
class TestPattern {
  public:
    TestPattern(iec61850::SvLayout const& layout, double amplitude, double frequency_hz, double rate_hz);

    /// Writes sample `index` into the octets of a sample.
    void write(std::int64_t index, std::span<std::uint8_t> sample) const;

  private:
    struct Channel {
        std::size_t slot{0};
        double lag{0}; ///< of its phase, in turns
        bool is_sum{false};
    };
    iec61850::SvLayout const& layout_;
    double amplitude_, turns_per_sample_;
    std::vector<Channel> channels_;
};

} // namespace gridspace::wire

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/fuse/fuse.hpp"

#include <cstddef>
#include <vector>

namespace gridspace::sim {

/// One link of a fuse: current in, damage out. Its damage is the sum of dt / t(I) over the melting curve t(I); at 1 it
/// melts. It also melts when the integral of i^2 over the last period reaches the pre-arcing I2t: no heat leaves the
/// link within so short a time. What it has taken stays; it does not cool.
class FuseElement {
  public:
    FuseElement(FuseType const& type, double frequency_hz) : type_{type}, period_s_{1 / frequency_hz} {}

    /// An r.m.s. current that lasted for h. True: the link melts in this time.
    bool carry_rms(double i_a, double h);
    /// An instantaneous current that went on a straight line from the last one to `i_a` in a time of h. I is its r.m.s.
    /// over a period: each bit of i^2 dt counts 1 / (I^2 t(I)) with the larger of the two periods that begin and end
    /// with it, so a fault counts from its first sample on.
    bool carry(double i_a, double h);

    [[nodiscard]] double damage() const { return damage_; } ///< p.u.; 1: molten
    [[nodiscard]] bool molten() const { return damage_ >= 1; }
    /// When within the last step it melted, as a share of it.
    [[nodiscard]] double melted_share() const { return melted_share_; }

  private:
    struct Sample {
        double h, a2s, rms_a;
    };
    void forget_before(double window_s, double rms_a);
    void keep(Sample const& sample);
    bool take(double damage, double melts_at);

    FuseType type_;
    double period_s_;
    double damage_{0}, melted_share_{1};
    double i_a_{0}, rms_a_{0};
    std::vector<Sample> last_; ///< period: a ring
    std::size_t first_{0}, count_{0};
    double window_s_{0}, window_a2s_{0}; ///< of last_
    double before_{0};                   ///< damage by what is older
};

} // namespace gridspace::sim

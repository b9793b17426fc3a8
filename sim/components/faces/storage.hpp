// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <algorithm>
#include <cmath>
#include <string>

/// What stores of energy behind a converter have in common: a battery, a supercapacitor.
namespace gridspace::sim {

/// Power out of the store where the converter gives `given_kw` to the network; negative: into it.
inline double power_of_store(double given_kw, double efficiency) {
    return given_kw > 0 ? given_kw / efficiency : given_kw * efficiency;
}

/// An active power within what a rating leaves beside a reactive one.
inline double beside_reactive(double p_kw, double q_kvar, double rating_kva) {
    double const most = std::sqrt(std::max(0.0, rating_kva * rating_kva - q_kvar * q_kvar));
    return std::clamp(p_kw, -most, most);
}

/// Powers that are together more than the rating are a mistake.
void check_powers(config::Fields& f, std::string const& name, double p_kw, double q_kvar, double rating_kva);

/// Where the charge x of a store (percent) is in the phasor simulation: between its limits, or at one. Meeting a limit
/// and leaving it are events.
class StoreLimits {
  public:
    StoreLimits(double lowest, double highest) : lowest_{lowest}, highest_{highest} {}

    void start(double x) { at_ = x <= lowest_ ? -1 : x >= highest_ ? 1 : 0; }
    [[nodiscard]] bool empty() const { return at_ < 0; }
    [[nodiscard]] bool full() const { return at_ > 0; }
    /// Crosses zero from above when it meets a limit that it may move to, or has left the one where it was.
    [[nodiscard]] double event(double x, bool falls, bool rises) const {
        if (at_ < 0) {
            return lowest_ + kLeft - x;
        }
        if (at_ > 0) {
            return x - highest_ + kLeft;
        }
        double const above = x - lowest_, below = highest_ - x;
        return falls && rises ? std::min(above, below) : falls ? above : rises ? below : 1;
    }
    void on_event(double& x) {
        if (at_ != 0) {
            at_ = 0;
            return;
        }
        at_ = x - lowest_ < highest_ - x ? -1 : 1;
        x = at_ < 0 ? lowest_ : highest_;
    }

  private:
    static constexpr double kLeft = 1e-6; ///< this far from a limit it is no longer at it
    double lowest_, highest_;
    int at_{0}; ///< -1: empty, 1: full
};

} // namespace gridspace::sim

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/ride_through.hpp"

namespace gridspace::sim::emt {

/// Whether a source behind a converter may give current, by what it sees of the grid (GridRules).
class GridWatch {
  public:
    explicit GridWatch(GridRules rules) : rules_{std::move(rules)}, outside_s_(rules_.trips.size()) {}

    /// What it saw for a time of h: voltage (p.u.) and deviation from nominal frequency (a share).
    void step(double v, double f, double h);
    /// From now on without current until the grid has been fit.
    void wait_for_grid();
    /// While `on`, it stays ceased.
    void hold(bool on) { held_ = on; }
    /// It has tripped, or waits for a grid: its control rests.
    [[nodiscard]] bool ceased() const { return ceased_; }
    /// Of the current that is wanted, 0 to 1.
    [[nodiscard]] double share() const { return share_; }

  private:
    GridRules rules_;
    std::vector<double> outside_s_; ///< by trip, for how long
    double inside_s_{0}, momentary_s_{0}, share_{1}, ramp_s_{1};
    bool ceased_{false}, held_{false};
};

} // namespace gridspace::sim::emt

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/grid_watch.hpp"

#include <algorithm>

namespace gridspace::sim::emt {
namespace {

/// The voltage is outside for so long before a momentary cessation: shorter than the 83 ms of IEEE 1547-2018, longer
/// than what switching does to a filtered voltage.
constexpr double kResponseS = 0.03;

} // namespace

void GridWatch::step(double v, double f, double h) {
    bool trips = false;
    for (std::size_t i = 0; i < outside_s_.size(); ++i) {
        outside_s_[i] = rules_.trips[i].window.left(v, f) ? outside_s_[i] + h : 0;
        trips = trips || outside_s_[i] >= rules_.trips[i].after_s;
    }
    inside_s_ = rules_.fit.within(v, f) ? inside_s_ + h : 0;
    if (trips) {
        ceased_ = true;
    } else if (ceased_ && !held_ && inside_s_ >= rules_.fit_s) {
        ceased_ = false;
        ramp_s_ = rules_.ramp_s;
    }
    momentary_s_ = rules_.momentary && rules_.momentary->left(v, f) ? momentary_s_ + h : 0;
    bool const pauses = momentary_s_ >= kResponseS;
    if (pauses && share_ == 1) { // who was still entering service goes on along that ramp
        ramp_s_ = rules_.restore_s;
    }
    share_ = ceased_ || pauses ? 0 : std::min(1.0, share_ + h / ramp_s_);
}

void GridWatch::wait_for_grid() {
    ceased_ = true;
    share_ = 0;
    inside_s_ = momentary_s_ = 0;
    std::ranges::fill(outside_s_, 0.0);
}

} // namespace gridspace::sim::emt

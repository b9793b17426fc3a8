// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/detector/standing_difference.hpp"

#include "common/elementary.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gridspace::ids {
namespace {

constexpr double kTwoPi = 6.283185307179586;
/// Half of each new cycle: noise is averaged a little, and off the nominal frequency the estimate is two cycles old.
constexpr double kWeight = 0.5;
/// A current so much larger is that of a fault elsewhere, and so is what the chain makes of it; after a second it is
/// load.
constexpr double kHeavy = 1.5;
constexpr int kHeavyCycles = 60;
/// Below this current a share of it says nothing.
constexpr double kLeastCurrentPercent = 5;

} // namespace

StandingDifference::StandingDifference(StandingParams const& params) : params_{params} {
    auto const n = static_cast<std::size_t>(params_.cycle);
    cos_.resize(n);
    sin_.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
        double const angle = kTwoPi * static_cast<double>(k) / static_cast<double>(n);
        cos_[k] = elementary::cos(angle);
        sin_[k] = elementary::sin(angle);
    }
    restart();
}

void StandingDifference::restart() {
    for (Phase& phase : phases_) {
        std::vector<double> memory = std::move(phase.standing); // no allocation but the first
        memory.assign(static_cast<std::size_t>(params_.cycle), 0);
        phase = {};
        phase.standing = std::move(memory);
    }
    patience_ = heavy_ = cycles_ = quiet_cycles_ = samples_ = 0;
    learnt_base_a_ = 0;
    cycle_ = -1;
    known_ = disturbed_ = moved_ = false;
    percent_ = 0;
    remaining_ = {};
}

Abc const& StandingDifference::step(Input const& in) {
    std::int64_t const cycle = in.index / params_.cycle;
    auto const at = static_cast<std::size_t>(in.index % params_.cycle);
    if (cycle != cycle_) { // samples are missing: half a cycle says nothing
        begin_cycle(cycle);
    }
    bool const compensates = known_ && !beyond_classes();
    bool differs = false;
    for (std::size_t p = 0; p < 3; ++p) {
        double const whole = in.difference_a[p];
        double const without = whole - (compensates ? phases_[p].standing[at] : 0);
        remaining_[p] = std::fabs(without) < std::fabs(whole) ? without : whole; // it may have ended
        differs = differs || !(std::fabs(remaining_[p]) <= in.limit_a);
    }
    // A fault, an external one behind errors of the chain, or a forgery is no standing difference while it is new.
    patience_ = differs ? std::min(patience_ + 1, params_.patience_cycles * params_.cycle) : 0;
    bool const heavy = known_ && in.base_a > kHeavy * learnt_base_a_;
    heavy_ = heavy ? std::min(heavy_ + 1, kHeavyCycles * params_.cycle) : 0;
    bool const is_new = (differs && patience_ < params_.patience_cycles * params_.cycle) ||
                        (heavy && heavy_ < kHeavyCycles * params_.cycle);
    bool const learns = !known_ || !is_new;
    learnt_base_a_ = learns ? in.base_a : learnt_base_a_;
    for (std::size_t p = 0; p < 3; ++p) {
        Phase& phase = phases_[p];
        if (learns) {
            double& standing = phase.standing[at];
            standing = known_ ? standing + kWeight * (in.difference_a[p] - standing) : in.difference_a[p];
        }
        phase.difference.re += in.difference_a[p] * cos_[at];
        phase.difference.im -= in.difference_a[p] * sin_[at];
        phase.current.re += in.current_a[p] * cos_[at];
        phase.current.im -= in.current_a[p] * sin_[at];
        phase.direct += in.difference_a[p];
    }
    disturbed_ = disturbed_ || differs || in.disturbed;
    if (++samples_ == params_.cycle) {
        end_cycle(in.base_a);
        begin_cycle(cycle + 1);
    }
    return remaining_;
}

void StandingDifference::begin_cycle(std::int64_t cycle) {
    cycle_ = cycle;
    samples_ = 0;
    disturbed_ = false;
    for (Phase& phase : phases_) {
        phase.difference = phase.current = {};
        phase.direct = 0;
    }
}

void StandingDifference::end_cycle(double base_a) {
    known_ = true;
    ++cycles_;
    quiet_cycles_ = disturbed_ ? 0 : quiet_cycles_ + 1;
    double largest = 0;
    for (Phase& phase : phases_) {
        double squares = 0;
        for (double const a : phase.standing) {
            squares += a * a;
        }
        largest = std::max(largest, std::sqrt(2 * squares / static_cast<double>(params_.cycle)));
    }
    percent_ = 100 * largest / base_a;
    bool above = false, far_above = false;
    for (Phase& phase : phases_) {
        if (quiet_cycles_ > 1) { // the cycle behind a change still holds some of it
            look_for_movement(phase, base_a);
        }
        far_above = far_above || phase.sum > params_.alarm_percent_cycles;
        above = above || phase.sum > params_.alarm_percent_cycles / 2;
    }
    moved_ = far_above || (moved_ && above);
}

void StandingDifference::look_for_movement(Phase& phase, double base_a) {
    double const n = params_.cycle;
    Complex const& i = phase.current;
    double const squares = i.re * i.re + i.im * i.im;
    double const current_a = 2 * std::sqrt(squares) / n, direct_a = phase.direct / n;
    if (!(current_a > kLeastCurrentPercent / 100 * base_a)) {
        return;
    }
    Complex const& d = phase.difference;
    Complex const share{(d.re * i.re + d.im * i.im) / squares, (d.im * i.re - d.re * i.im) / squares};
    auto const follow = [&](double weight) {
        phase.reference.re += weight * (share.re - phase.reference.re);
        phase.reference.im += weight * (share.im - phase.reference.im);
        phase.reference_a += weight * (current_a - phase.reference_a);
        phase.reference_direct_a += weight * (direct_a - phase.reference_direct_a);
    };
    if (quiet_cycles_ - 1 <= params_.learn_cycles && phase.sum == 0 && cycles_ <= 4 * params_.learn_cycles) {
        follow(1.0 / (quiet_cycles_ - 1)); // the mean of the first ones
        return;
    }
    // Charging current does not go with the load: within the classes the share may change as the load does.
    double const by_load = params_.class_percent / 100 * std::min(std::fabs(1 - current_a / phase.reference_a), 1.0);
    double const off_re = share.re - phase.reference.re, off_im = share.im - phase.reference.im;
    double const off = std::sqrt(off_re * off_re + off_im * off_im); // the same bits everywhere, unlike std::hypot
    double const percent =
        100 / base_a *
        std::max(std::max(off - by_load, 0.0) * current_a, std::fabs(direct_a - phase.reference_direct_a));
    phase.sum = std::clamp(phase.sum + percent - params_.slack_percent, 0.0, 2 * params_.alarm_percent_cycles);
    follow(1 / params_.forget_cycles);
}

} // namespace gridspace::ids

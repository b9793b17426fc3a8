// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/fuse/fuse_element.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::sim {

bool FuseElement::take(double damage, double melts_at) {
    if (damage > damage_) {
        melts_at = std::min(melts_at, (1 - damage_) / (damage - damage_));
        damage_ = damage;
    }
    if (melts_at > 1) {
        return false;
    }
    damage_ = 1;
    melted_share_ = std::max(melts_at, 0.0);
    return true;
}

bool FuseElement::carry_rms(double i_a, double h) {
    if (molten()) {
        return false;
    }
    double melting_s = type_.melting_time_s(i_a);
    if (i_a * i_a * period_s_ >= type_.adiabatic_a2s()) { // within a period
        melting_s = std::min(melting_s, type_.adiabatic_a2s() / (i_a * i_a));
    }
    return take(damage_ + h / melting_s, 2);
}

bool FuseElement::carry(double i_a, double h) {
    if (molten()) {
        return false;
    }
    double const a2s = h / 3 * (i_a_ * i_a_ + i_a_ * i_a + i_a * i_a);
    i_a_ = i_a;
    forget_before(period_s_ - h, rms_a_);
    double const adiabatic = a2s > 0 ? (type_.adiabatic_a2s() - window_a2s_) / a2s : 2;
    window_s_ += h;
    window_a2s_ += a2s;
    rms_a_ = std::sqrt(window_a2s_ / std::max(window_s_, period_s_));
    keep({h, a2s, rms_a_});
    return take(before_ + period_s_ / type_.melting_time_s(rms_a_), adiabatic);
}

/// What is older than the window has done its damage.
void FuseElement::forget_before(double window_s, double rms_a) {
    double const close = 1e-6 * period_s_; // rounding of sums of steps
    while (count_ > 0 && window_s_ > window_s + close) {
        Sample const& s = last_[first_];
        double const i_a = std::max(s.rms_a, rms_a);
        before_ += i_a > 0 ? s.a2s / (i_a * i_a * type_.melting_time_s(i_a)) : 0;
        window_s_ -= s.h;
        window_a2s_ = std::max(window_a2s_ - s.a2s, 0.0);
        first_ = (first_ + 1) % last_.size();
        --count_;
    }
}

void FuseElement::keep(Sample const& sample) {
    if (count_ == last_.size()) { // in the first period only
        std::rotate(last_.begin(), last_.begin() + static_cast<std::ptrdiff_t>(first_), last_.end());
        first_ = 0;
        last_.resize(std::max<std::size_t>(2 * count_, 64));
    }
    last_[(first_ + count_++) % last_.size()] = sample;
}

} // namespace gridspace::sim

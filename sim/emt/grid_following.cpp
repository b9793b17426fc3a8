// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/grid_following.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::sim::emt {
namespace {

/// Below this share of nominal voltage the current no longer rises to hold the power.
constexpr double kMinVoltage = 0.5;

constexpr double kDead = 0.05; ///< p.u.: nothing to lock on

} // namespace

GridFollowing::GridFollowing(double frequency_hz, double nominal_peak_v, double max_peak_a,
                             std::optional<GridRules> rules)
    : pll_{frequency_hz}, nominal_{nominal_peak_v}, max_peak_a_{max_peak_a}, frequency_hz_{frequency_hz} {
    if (rules) {
        shift_ = rules->shift;
        watch_ = std::make_unique<GridWatch>(std::move(*rules));
    }
}

std::complex<double> GridFollowing::reference(std::complex<double> power) const {
    std::complex<double> i = std::conj(power) / (1.5 * std::max(voltage_, kMinVoltage * nominal_));
    if (shift_) {
        i *= std::polar(1.0, shift_->lead_rad(pll_.frequency_hz() - frequency_hz_));
    }
    constexpr double kNear = 0.99; // its exact length takes long, and is seldom needed
    if (!(max_peak_a_ > 0) || std::norm(i) < kNear * max_peak_a_ * max_peak_a_) {
        return i;
    }
    double const size = std::abs(i);
    return size > max_peak_a_ ? i * (max_peak_a_ / size) : i;
}

std::complex<double> GridFollowing::start(std::complex<double> v, std::complex<double> power) {
    pll_.start(v.real(), v.imag());
    voltage_ = std::abs(v);
    current_ = reference(power);
    return current_ * std::polar(1.0, std::arg(v));
}

void GridFollowing::control(std::complex<double> power, double h, double current_share) {
    if (watch_) {
        watch_->step(voltage_pu(), pll_.frequency_hz() / frequency_hz_ - 1, h);
        if (ceased() && voltage_pu() < kDead) {
            pll_.rest();
        }
    }
    std::complex<double> const wanted = ceased() ? 0 : reference(power);
    current_ += ((share() < 1 ? share() * wanted : wanted) - current_) * current_share;
}

void GridFollowing::resume(std::complex<double> v) {
    (void)start(v, 0);
    tripped_ = false;
    if (watch_) {
        watch_->wait_for_grid();
    }
}

void GridFollowing::stand_by(bool on) {
    stands_by_ = on;
    if (watch_) {
        watch_->hold(on);
        watch_->wait_for_grid();
    }
}

void GridFollowing::trip() {
    tripped_ = true;
    current_ = 0;
}

} // namespace gridspace::sim::emt

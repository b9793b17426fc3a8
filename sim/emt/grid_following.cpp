// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/grid_following.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::sim::emt {
namespace {

/// Below this share of nominal voltage the current no longer rises to hold the power.
constexpr double kMinVoltage = 0.5;

// When a source ceases and comes back (grid_following.hpp): p.u., shares of nominal frequency, seconds.
constexpr double kUnfitBelow = 0.5, kUnfitAbove = 1.2, kUnfitFrequency = 0.1, kUnfitS = 0.16;
constexpr double kFitBelow = 1.1, kFitAbove = 0.88, kFitFrequency = 0.01, kFitS = 0.2, kRampS = 0.4;
constexpr double kDead = 0.05; ///< p.u.: nothing to lock on

} // namespace

GridFollowing::GridFollowing(double frequency_hz, double nominal_peak_v, double max_peak_a, bool ceases)
    : pll_{frequency_hz}, nominal_{nominal_peak_v}, max_peak_a_{max_peak_a}, frequency_hz_{frequency_hz},
      ceases_{ceases} {}

std::complex<double> GridFollowing::reference(std::complex<double> power) const {
    std::complex<double> i = std::conj(power) / (1.5 * std::max(voltage_, kMinVoltage * nominal_));
    double const size = std::abs(i);
    return max_peak_a_ > 0 && size > max_peak_a_ ? i * (max_peak_a_ / size) : i;
}

std::complex<double> GridFollowing::start(std::complex<double> v, std::complex<double> power) {
    pll_.start(v.real(), v.imag());
    voltage_ = std::abs(v);
    current_ = reference(power);
    return current_ * std::polar(1.0, std::arg(v));
}

std::array<double, 3> GridFollowing::currents(double h) const {
    auto const [c, s] = pll_.ahead(h);
    return to_phases({current_.real() * c - current_.imag() * s, current_.real() * s + current_.imag() * c, 0});
}

void GridFollowing::step(Space const& v, std::complex<double> power, double h) {
    pll_.step(v.alpha, v.beta, h);
    if (tripped_) {
        return;
    }
    voltage_ += (std::sqrt(v.alpha * v.alpha + v.beta * v.beta) - voltage_) * h / (kVoltageLagS + h);
    if (ceases_) {
        watch_grid(h);
    }
    std::complex<double> const wanted = ceased_ ? 0 : reference(power);
    current_ += ((share_ < 1 ? share_ * wanted : wanted) - current_) * (h / (kCurrentLagS + h));
}

void GridFollowing::watch_grid(double h) {
    double const v = voltage_pu(), off = std::abs(pll_.frequency_hz() / frequency_hz_ - 1);
    outside_s_ = v < kUnfitBelow || v > kUnfitAbove || off > kUnfitFrequency ? outside_s_ + h : 0;
    inside_s_ = v > kFitAbove && v < kFitBelow && off < kFitFrequency ? inside_s_ + h : 0;
    if (outside_s_ >= kUnfitS) {
        ceased_ = true;
        share_ = 0;
    } else if (ceased_ && !stands_by_ && inside_s_ >= kFitS) {
        ceased_ = false;
    }
    if (ceased_ && v < kDead) {
        pll_.rest();
    }
    share_ = ceased_ ? 0 : std::min(1.0, share_ + h / kRampS);
}

void GridFollowing::resume(std::complex<double> v) {
    (void)start(v, 0);
    tripped_ = false;
    wait_for_grid();
}

void GridFollowing::stand_by(bool on) {
    stands_by_ = on;
    wait_for_grid();
}

void GridFollowing::wait_for_grid() {
    ceased_ = ceases_ || stands_by_;
    share_ = ceased_ ? 0 : 1;
    outside_s_ = inside_s_ = 0;
}

void GridFollowing::trip() {
    tripped_ = true;
    current_ = 0;
}

} // namespace gridspace::sim::emt

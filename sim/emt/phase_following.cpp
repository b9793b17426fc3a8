// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/phase_following.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

/// Below this share of nominal voltage the current no longer rises to hold the power.
constexpr double kMinPhaseVoltage = 0.5;

} // namespace

PhaseFollowing::PhaseFollowing(double frequency_hz, double nominal_peak_v)
    : w_{2 * std::numbers::pi * frequency_hz}, nominal_{nominal_peak_v} {}

std::complex<double> PhaseFollowing::wanted(Phase const& p, std::complex<double> power) const {
    double const size = std::max(p.size, kMinPhaseVoltage * nominal_);
    return 2.0 * std::conj(power) / (size * size);
}

std::array<std::complex<double>, 3> PhaseFollowing::start(std::array<std::complex<double>, 3> const& v,
                                                          Powers const& power) {
    std::array<std::complex<double>, 3> out;
    for (std::size_t k = 0; k < 3; ++k) {
        phases_[k] = {v[k].real(), v[k].real(), v[k].imag(), std::abs(v[k]), {}};
        phases_[k].admittance = wanted(phases_[k], power[k]);
        out[k] = phases_[k].admittance * v[k];
    }
    return out;
}

void PhaseFollowing::use_step(double h) {
    if (h != h_) {
        h_ = h;
        cos_ = std::cos(w_ * h);
        sin_ = std::sin(w_ * h);
        tan_half_ = std::tan(w_ * h / 2);
    }
}

std::array<double, 3> PhaseFollowing::currents(double h) {
    std::array<double, 3> out{};
    if (tripped_) {
        return out;
    }
    use_step(h);
    double const c = cos_, s = sin_;
    for (std::size_t k = 0; k < 3; ++k) {
        Phase const& p = phases_[k];
        out[k] = p.admittance.real() * (p.x1 * c - p.x2 * s) - p.admittance.imag() * (p.x1 * s + p.x2 * c);
    }
    return out;
}

void PhaseFollowing::step(std::array<double, 3> const& v, Powers const& power, double h) {
    // Trapezoidal rule at the frequency that it turns into the true one: no error of phase or size in the steady state.
    use_step(h);
    double const a = tan_half_;
    for (std::size_t k = 0; k < 3; ++k) {
        Phase& p = phases_[k];
        double const r1 = p.x1 + a * (kGain * (v[k] + p.v - p.x1) - p.x2), r2 = p.x2 + a * p.x1;
        double const x1 = (r1 - a * r2) / (1 + a * kGain + a * a);
        p.x2 = r2 + a * x1;
        p.x1 = x1;
        p.v = v[k];
        double const size = std::sqrt(p.x1 * p.x1 + p.x2 * p.x2);
        p.size += (size - p.size) * h / (kVoltageLagS + h);
        p.admittance += (wanted(p, power[k]) - p.admittance) * (h / (kAdmittanceLagS + h));
    }
}

} // namespace gridspace::sim::emt

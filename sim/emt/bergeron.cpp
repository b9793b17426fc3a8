// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/bergeron.hpp"

#include "sim/circuit/space.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

using Complex = std::complex<double>;

std::array<double, 3> modes(double const* phases) {
    Space const s = to_space(phases[0], phases[1], phases[2]);
    return {s.alpha, s.beta, s.zero};
}

} // namespace

BergeronWaves::BergeronWaves(BergeronLine const& l, double step_s)
    : z_{l.z1 + l.r1 / 4, l.z1 + l.r1 / 4, l.z0 + l.r0 / 4},
      h_{(l.z1 - l.r1 / 4) / z_[0], (l.z1 - l.r1 / 4) / z_[0], (l.z0 - l.r0 / 4) / z_[2]}, tau_{l.tau1, l.tau1, l.tau0},
      surge_{l.z1, l.z1, l.z0}, r_{l.r1, l.r1, l.r0}, step_s_{step_s} {
    // Events cut steps: more entries than a travel time has steps, with room for many of them. A cut of the line looks
    // back two travel times.
    auto const steps = static_cast<std::size_t>(std::ceil(std::max(l.tau1, l.tau0) / step_s));
    past_ = {4 * steps + 256, step_s};
}

PhaseMatrix BergeronWaves::conductance() const {
    return PhaseMatrix::sequence(1 / z_[0], 1 / z_[2]);
}

BergeronWaves::Steady BergeronWaves::steady(double w) const {
    auto const mode = [&](std::size_t m) {
        Complex const e = std::polar(1.0, -w * tau_[m]);
        double const h = h_[m];
        Complex const a = 1.0 + e * h * (1 - h) / 2.0, b = e * h * (1 + h) / 2.0;
        Complex const c = (1.0 - e * (1 - h) / 2.0) / z_[m], d = -e * (1 + h) / 2.0 / z_[m];
        Complex const det = a * a - b * b;
        return std::pair{(a * c - b * d) / det, (a * d - b * c) / det};
    };
    auto const [own1, cross1] = mode(0);
    auto const [own0, cross0] = mode(2);
    return {ComplexPhaseMatrix::sequence(own1, own0), ComplexPhaseMatrix::sequence(cross1, cross0)};
}

void BergeronWaves::start(double w, Phasors const& v, Phasors const& i) {
    past_.clear();
    std::size_t const count = past_.size() / 2;
    for (std::size_t n = 0; n < count; ++n) {
        double const t = -static_cast<double>(count - 1 - n) * step_s_;
        std::array<double, 6> volts{}, amperes{};
        for (std::size_t end = 0; end < 2; ++end) {
            for (std::size_t k = 0; k < 3; ++k) {
                Complex const turn = std::polar(1.0, w * t);
                volts[3 * end + k] = (v[end][k] * turn).real();
                amperes[3 * end + k] = (i[end][k] * turn).real();
            }
        }
        open(t);
        leave(0, volts.data(), amperes.data());
        leave(1, volts.data() + 3, amperes.data() + 3);
    }
}

BergeronWaves::Found BergeronWaves::find(double t, std::size_t end, std::size_t mode) const {
    auto const [a, b, share] = past_.around(t);
    return {a.f[end][mode] + share * (b.f[end][mode] - a.f[end][mode]),
            a.i[end][mode] + share * (b.i[end][mode] - a.i[end][mode])};
}

BergeronWaves::Inside BergeronWaves::inside(double t, double x) const {
    std::array<double, 3> volts{}, amperes{};
    for (std::size_t m = 0; m < 3; ++m) {
        // F = v/Z + h i  ->  the wave v + Zc i that left an end
        auto const left = [&](double when, std::size_t end) {
            Found const w = find(when, end, m);
            return z_[m] * w.f + (surge_[m] - h_[m] * z_[m]) * w.i;
        };
        double const forth = left(t - x * tau_[m], 0) * std::exp(-x * r_[m] / (2 * surge_[m]));
        double const back = left(t - (1 - x) * tau_[m], 1) * std::exp(-(1 - x) * r_[m] / (2 * surge_[m]));
        volts[m] = (forth + back) / 2;
        amperes[m] = (forth - back) / (2 * surge_[m]);
    }
    return {to_phases({volts[0], volts[1], volts[2]}), to_phases({amperes[0], amperes[1], amperes[2]})};
}

void BergeronWaves::continue_from(BergeronWaves const& whole, double t_now, double x0, double x1) {
    past_.clear();
    std::size_t const count = past_.size() / 2;
    for (std::size_t n = 0; n < count; ++n) {
        double const t = t_now - static_cast<double>(count - 1 - n) * step_s_;
        Inside const near = whole.inside(t, x0), far = whole.inside(t, x1);
        std::array<double, 6> volts{}, amperes{};
        for (std::size_t k = 0; k < 3; ++k) {
            volts[k] = near.v[k];
            volts[3 + k] = far.v[k];
            amperes[k] = near.i[k];
            amperes[3 + k] = -far.i[k];
        }
        open(t);
        leave(0, volts.data(), amperes.data());
        leave(1, volts.data() + 3, amperes.data() + 3);
    }
}

void BergeronWaves::history(double t, std::size_t end, double* out) const {
    std::array<double, 3> m{};
    for (std::size_t k = 0; k < 3; ++k) {
        m[k] = -(1 + h_[k]) / 2 * at(t - tau_[k], 1 - end, k) - (1 - h_[k]) / 2 * at(t - tau_[k], end, k);
    }
    auto const phases = to_phases({m[0], m[1], m[2]});
    std::copy(phases.begin(), phases.end(), out);
}

void BergeronWaves::open(double t) {
    past_.next().t = t;
}

void BergeronWaves::leave(std::size_t end, double const* v, double const* i) {
    Wave& wave = past_.newest();
    auto const volts = modes(v), amperes = modes(i);
    for (std::size_t k = 0; k < 3; ++k) {
        wave.f[end][k] = volts[k] / z_[k] + h_[k] * amperes[k];
        wave.i[end][k] = amperes[k];
    }
}

} // namespace gridspace::sim::emt

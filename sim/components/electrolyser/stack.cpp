// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/electrolyser/stack.hpp"

#include <cmath>
#include <numbers>

namespace gridspace::sim {
namespace {

constexpr double kFaraday = 96485.33212; ///< C / mol
constexpr double kHydrogenGramsPerMol = 2.01588;
constexpr double kKelvin = 273.15;

} // namespace

double Stack::reversible_v() const {
    double const t = temperature_c + kKelvin;
    return 1.5184 - 1.5421e-3 * t + 9.523e-5 * t * std::log(t) + 9.84e-8 * t * t;
}

double Stack::resistance_ohm_m2() const {
    return curve.r1 + curve.r2 * temperature_c;
}

double Stack::activation_m2_per_a() const {
    return curve.t1 + curve.t2 / temperature_c + curve.t3 / (temperature_c * temperature_c);
}

double Stack::cell_v(double i) const {
    double const density = i / area_m2;
    return reversible_v() + resistance_ohm_m2() * density +
           curve.s / std::numbers::ln10 * std::log1p(activation_m2_per_a() * density);
}

double Stack::current_a(double power_w) const {
    // I U(I) is convex and rises, and U >= U_rev: Newton's steps come down from the upper bound and never pass the
    // root.
    constexpr int kMost = 30;
    double const per_cell = power_w / cells, a = activation_m2_per_a();
    double i = per_cell / reversible_v();
    for (int step = 0; step < kMost; ++step) {
        double const u = cell_v(i), density = i / area_m2;
        double const slope = (resistance_ohm_m2() + curve.s / std::numbers::ln10 * a / (1 + a * density)) / area_m2;
        double const down = (i * u - per_cell) / (u + i * slope);
        i -= down;
        if (down <= 1e-15 * i) {
            break;
        }
    }
    return i;
}

double Stack::hydrogen_g_per_s(double i) const {
    double const density = 0.1 * i / area_m2, square = density * density; // mA / cm2
    double const efficiency = square == 0 ? 0 : square / (curve.f1 + square) * curve.f2;
    return efficiency * cells * i / (2 * kFaraday) * kHydrogenGramsPerMol;
}

} // namespace gridspace::sim

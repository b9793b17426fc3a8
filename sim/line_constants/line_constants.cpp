// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/line_constants/line_constants.hpp"

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>

namespace gridspace::sim {
namespace {

using Complex = std::complex<double>;
constexpr double kMu0 = 4e-7 * std::numbers::pi, kEpsilon0 = 8.854187817e-12;

/// Inner impedance of a solid round wire, ohm/m: R z/2 I0(z) / I1(z), z the radius over the complex depth of
/// penetration, by the power series of the Bessel functions.
Complex wire_impedance(double dc_ohm_per_m, double omega) {
    if (dc_ohm_per_m <= 0) {
        return 0;
    }
    Complex const z2 = Complex{0, omega * kMu0 / (std::numbers::pi * dc_ohm_per_m)} / 4.0;
    if (std::abs(z2) > 100) { // the series would need too many terms: the asymptotic one [Abramowitz and Stegun 9.7.1]
        Complex const z = 2.0 * std::sqrt(z2);
        return dc_ohm_per_m * (z / 2.0 + 1.0 / 4.0 + 3.0 / (16.0 * z) + 3.0 / (16.0 * z * z));
    }
    Complex term{1}, zero{1}, one{1}; // I0(z), and I1(z) / (z/2)
    for (int k = 1; k < 60; ++k) {
        term *= z2 / static_cast<double>(k * k);
        zero += term;
        one += term / static_cast<double>(k + 1);
    }
    return dc_ohm_per_m * zero / one;
}

} // namespace

LineConstants line_constants(std::vector<Conductor> const& conductors, int phases, double frequency_hz,
                             double rho_ohm_m, EarthModel model) {
    double const omega = 2 * std::numbers::pi * frequency_hz;
    Complex const factor{0, omega * kMu0 / (2 * std::numbers::pi)};
    Complex const depth = 1.0 / std::sqrt(Complex{0, omega * kMu0 / rho_ohm_m});
    auto const n = static_cast<int>(conductors.size());
    Eigen::MatrixXcd z(n, n);
    Eigen::MatrixXd p(n, n);
    auto const earth = [&](Conductor const& a, Conductor const& b) -> Complex {
        if (model == EarthModel::carson) {
            return Complex{omega * kMu0 / 8, 0} + factor * std::log(658.5 * std::sqrt(rho_ohm_m / frequency_hz));
        }
        Complex const height = a.height_m + b.height_m + 2.0 * depth;
        double const aside = a.x_m - b.x_m;
        return factor * std::log(std::sqrt(height * height + aside * aside));
    };
    for (int i = 0; i < n; ++i) {
        Conductor const& a = conductors[static_cast<std::size_t>(i)];
        if (a.gmr_m > 0) {
            double const r =
                model == EarthModel::carson ? a.ac_ohm_per_m : wire_impedance(a.dc_ohm_per_m, omega).real();
            z(i, i) = r - factor * std::log(a.gmr_m) + earth(a, a);
        } else {
            z(i, i) = wire_impedance(a.dc_ohm_per_m, omega) - factor * std::log(a.radius_m) + earth(a, a);
        }
        p(i, i) = std::log(2 * a.height_m / a.radius_m) / (2 * std::numbers::pi * kEpsilon0);
        for (int j = 0; j < i; ++j) {
            Conductor const& b = conductors[static_cast<std::size_t>(j)];
            double const aside = a.x_m - b.x_m, apart = std::hypot(aside, a.height_m - b.height_m);
            z(i, j) = z(j, i) = earth(a, b) - factor * std::log(apart);
            p(i, j) = p(j, i) =
                std::log(std::hypot(aside, a.height_m + b.height_m) / apart) / (2 * std::numbers::pi * kEpsilon0);
        }
    }
    int const rest = n - phases;
    LineConstants out{z.topLeftCorner(phases, phases), p.inverse().topLeftCorner(phases, phases)};
    if (rest > 0) {
        out.z_ohm_per_m -= z.topRightCorner(phases, rest) * z.bottomRightCorner(rest, rest).inverse() *
                           z.bottomLeftCorner(rest, phases);
    }
    return out;
}

} // namespace gridspace::sim

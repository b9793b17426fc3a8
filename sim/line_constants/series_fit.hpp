// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <vector>

namespace gridspace::sim {

/// A series impedance of resistances and inductances: r + s l, and stages of an inductance parallel to a resistance
/// (Foster): what skin effect and earth return look like, whatever their values. Passive and causal.
struct SeriesImpedance {
    double r_ohm{0}, l_h{0};
    std::vector<double> corners, inductances; ///< rad/s and H of each stage

    [[nodiscard]] std::complex<double> at(double omega) const {
        std::complex<double> const s{0, omega};
        std::complex<double> z = r_ohm + s * l_h;
        for (std::size_t k = 0; k < corners.size(); ++k) {
            z += s * inductances[k] * corners[k] / (s + corners[k]);
        }
        return z;
    }
};

/// The one that is nearest to samples, resistances and reactances each by their relative error: corners four a decade,
/// non-negative least squares [Lawson and Hanson, Solving Least Squares Problems, 1974, chapter 23].
[[nodiscard]] SeriesImpedance fit_series(std::vector<double> const& omega,
                                         std::vector<std::complex<double>> const& z_ohm);

/// Root mean square of these relative errors.
[[nodiscard]] double series_error(std::vector<double> const& omega, std::vector<std::complex<double>> const& z_ohm,
                                  SeriesImpedance const& fit);

} // namespace gridspace::sim

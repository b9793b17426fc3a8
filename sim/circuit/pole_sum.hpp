// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <vector>

namespace gridspace::sim::emt {

/// A rational function of s with real poles in the left half plane: constant + sum residue / (s + pole).
struct PoleSum {
    double constant{0};
    std::vector<double> poles;    ///< rad/s, all positive: the pole is at minus this
    std::vector<double> residues; ///< one for each pole

    [[nodiscard]] std::complex<double> at(std::complex<double> s) const {
        std::complex<double> sum{constant};
        for (std::size_t k = 0; k < poles.size(); ++k) {
            sum += residues[k] / (s + poles[k]);
        }
        return sum;
    }
};

} // namespace gridspace::sim::emt

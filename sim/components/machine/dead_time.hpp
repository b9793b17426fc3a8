// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace gridspace::sim::machines {

/// A dead time T as states: the input over the last T seconds in Legendre polynomials, whose transfer function is the
/// Pade approximant [4/5] of exp(-s T). [Voelker and Eliasmith 2018, Neural Computation 30(3), pages 569 to 609]
/// A sine comes out with an error of 2e-9 of its size at w T = 1, 1e-4 at 3 and 1 % at 5.
struct DeadTime {
    static constexpr std::size_t kOrder = 5;
    /// The quickest of its modes is at 7.5 / T: the steps of waveforms have to follow it.
    static constexpr double kShortestS = 1e-3;

    /// m[i]: the input's coefficient of the polynomial i. Their sum is the input T ago.
    [[nodiscard]] static double output(double const* m) { return m[0] + m[1] + m[2] + m[3] + m[4]; }

    /// T m'[i] = (2 i + 1) ((-1)^i u - sum of m[j] with j > i or i - j even + sum of the other m[j])
    static void derivative(double const* m, double u, double t, double* dm) {
        for (std::size_t i = 0; i < kOrder; ++i) {
            double sum = i % 2 == 0 ? u : -u;
            for (std::size_t j = 0; j < kOrder; ++j) {
                bool const minus = j > i || (i - j) % 2 == 0;
                sum += minus ? -m[j] : m[j];
            }
            dm[i] = static_cast<double>(2 * i + 1) / t * sum;
        }
    }
};

} // namespace gridspace::sim::machines

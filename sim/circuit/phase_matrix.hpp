// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>

namespace gridspace::sim::emt {

/// A 3x3 matrix with equal diagonal and equal off-diagonal entries: what a transposed line, a star of equal impedances
/// or an earthed machine is. Known by its positive and zero sequence value; y_k = one x_k + mutual (x_a + x_b + x_c).
template <class S>
struct PhaseMatrixOf {
    S one{};    ///< positive (and negative) sequence
    S mutual{}; ///< (zero - one) / 3

    [[nodiscard]] static PhaseMatrixOf sequence(S positive, S zero) { return {positive, (zero - positive) / S(3)}; }
    [[nodiscard]] S zero() const { return one + S(3) * mutual; }
    [[nodiscard]] S own() const { return one + mutual; }
    [[nodiscard]] S entry(int row, int column) const { return row == column ? own() : mutual; }
};
using PhaseMatrix = PhaseMatrixOf<double>;
using ComplexPhaseMatrix = PhaseMatrixOf<std::complex<double>>;

} // namespace gridspace::sim::emt

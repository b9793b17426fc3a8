// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace gridspace::sim::emt {

/// A full 3x3 matrix: what couples the phases of a line that is not transposed. By row.
template <class S>
using Matrix3Of = std::array<std::array<S, 3>, 3>;
using Matrix3 = Matrix3Of<double>;

template <class S>
[[nodiscard]] Matrix3Of<S> diagonal(S a, S b, S c) {
    Matrix3Of<S> m{};
    m[0][0] = a;
    m[1][1] = b;
    m[2][2] = c;
    return m;
}

/// By cofactors; the caller knows that it exists.
template <class S>
[[nodiscard]] Matrix3Of<S> inverse(Matrix3Of<S> const& m) {
    auto const minor = [&](std::size_t i, std::size_t j) {
        std::size_t const r = (i + 1) % 3, q = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
        return m[r][c] * m[q][d] - m[r][d] * m[q][c]; // cyclic: with its sign
    };
    S const determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    Matrix3Of<S> out{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            out[i][j] = minor(j, i) / determinant;
        }
    }
    return out;
}

template <class S>
[[nodiscard]] Matrix3Of<S> product(Matrix3Of<S> const& a, Matrix3Of<S> const& b) {
    Matrix3Of<S> out{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
        }
    }
    return out;
}

/// a x + b y, entry by entry.
template <class S>
[[nodiscard]] Matrix3Of<S> combined(S x, Matrix3Of<S> const& a, S y, Matrix3Of<S> const& b) {
    Matrix3Of<S> out{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            out[i][j] = x * a[i][j] + y * b[i][j];
        }
    }
    return out;
}

} // namespace gridspace::sim::emt

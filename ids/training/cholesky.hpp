// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace gridspace::ids {

/// Solves A x = b for a symmetric positive definite A (n x n, row by row; only the lower triangle is read, and
/// overwritten). b is overwritten with x. False when A is not positive definite.
[[nodiscard]] bool solve_positive_definite(std::vector<double>& a, std::vector<double>& b, std::size_t n);

} // namespace gridspace::ids

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseLU>
#include <complex>

/// Eigen's sparse LU factorization of real and complex matrices, compiled once for all: it takes the compiler longer than
/// what uses it.
extern template class Eigen::SparseLU<Eigen::SparseMatrix<double>>;
extern template class Eigen::SparseLU<Eigen::SparseMatrix<std::complex<double>>>;

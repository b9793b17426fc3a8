// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseLU>
#include <complex>

/// Eigen's sparse LU factorization of real and complex matrices, compiled once for all: it takes the compiler longer
/// than what uses it.
extern template void Eigen::SparseLU<Eigen::SparseMatrix<double>>::analyzePattern(Eigen::SparseMatrix<double> const&);
extern template void Eigen::SparseLU<Eigen::SparseMatrix<double>>::factorize(Eigen::SparseMatrix<double> const&);
extern template void Eigen::SparseLU<Eigen::SparseMatrix<std::complex<double>>>::analyzePattern(
    Eigen::SparseMatrix<std::complex<double>> const&);
extern template void
Eigen::SparseLU<Eigen::SparseMatrix<std::complex<double>>>::factorize(Eigen::SparseMatrix<std::complex<double>> const&);

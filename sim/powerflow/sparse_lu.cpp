// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/sparse_lu.hpp"

template void Eigen::SparseLU<Eigen::SparseMatrix<double>>::analyzePattern(Eigen::SparseMatrix<double> const&);
template void Eigen::SparseLU<Eigen::SparseMatrix<double>>::factorize(Eigen::SparseMatrix<double> const&);
template void Eigen::SparseLU<Eigen::SparseMatrix<std::complex<double>>>::analyzePattern(
    Eigen::SparseMatrix<std::complex<double>> const&);
template void
Eigen::SparseLU<Eigen::SparseMatrix<std::complex<double>>>::factorize(Eigen::SparseMatrix<std::complex<double>> const&);

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/sparse_lu.hpp"

template class Eigen::SparseLU<Eigen::SparseMatrix<double>>;
template class Eigen::SparseLU<Eigen::SparseMatrix<std::complex<double>>>;

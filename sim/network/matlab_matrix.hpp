// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace gridspace::sim {

/// What cannot be evaluated, and why.
struct MatlabMistake : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Rows of equal length. A number is a matrix of one row and column.
using MatlabMatrix = std::vector<std::vector<double>>;

/// The constants that idx_bus, idx_brch and idx_gen of MATPOWER define (column numbers from 1).
std::map<std::string, double> const& matpower_columns();

/// A function of one number by its name, or null.
double (*matlab_function(std::string const& word))(double);

inline MatlabMatrix scalar(double v) {
    return {{v}};
}
inline bool is_scalar(MatlabMatrix const& m) {
    return m.size() == 1 && m[0].size() == 1;
}

/// Element by element; a scalar goes with everything.
template <class Op>
MatlabMatrix combine(MatlabMatrix const& a, MatlabMatrix const& b, Op const& op) {
    MatlabMatrix const& shape = is_scalar(a) ? b : a;
    if (!is_scalar(a) && !is_scalar(b) && (a.size() != b.size() || a[0].size() != b[0].size())) {
        throw MatlabMistake{"matrices of different size"};
    }
    MatlabMatrix out = shape;
    for (std::size_t r = 0; r < shape.size(); ++r) {
        for (std::size_t c = 0; c < shape[r].size(); ++c) {
            out[r][c] = op(is_scalar(a) ? a[0][0] : a[r][c], is_scalar(b) ? b[0][0] : b[r][c]);
        }
    }
    return out;
}

} // namespace gridspace::sim

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <utility>
#include <vector>

namespace gridspace::sim::emt {

/// An entry of a symmetric matrix; only row <= column is read, duplicates add up in the order given.
template <class S>
struct Entry {
    int row{0}, column{0};
    S value{};
};

/// Symmetric matrix as L D L' with a fill-reducing order and without pivoting: circuits of passive elements need none.
/// A pivot that vanishes belongs to a part without any connection to earth; its potential is set to zero there. Nothing
/// flows through that anchor, because the currents of such a part add up to zero. [up-looking factorisation along the
/// elimination tree; Davis, Direct Methods for Sparse Linear Systems, 2006, ch. 4]
template <class S>
class Ldlt {
  public:
    /// Factors the n x n matrix. Returns the unknowns at which an anchor was needed.
    std::vector<int> factor(int n, std::vector<Entry<S>> const& entries);
    /// x := A^-1 x; allocates nothing.
    void solve(S* x) const;
    [[nodiscard]] int size() const { return n_; }
    /// Multiplications in a solve.
    [[nodiscard]] std::size_t work() const { return 2 * rows_.values.size() + static_cast<std::size_t>(n_); }

  private:
    /// Rows or columns of L without its diagonal, one after the other.
    struct Lists {
        std::vector<int> start, places;
        std::vector<S> values;
        void clear(std::size_t count) {
            start.assign(1, 0);
            start.reserve(count + 1);
            places.clear();
            values.clear();
        }
        void add(std::vector<std::pair<int, S>> const& list, std::vector<int> const& place) {
            for (auto const& [at, value] : list) {
                places.push_back(place[static_cast<std::size_t>(at)]);
                values.push_back(value);
            }
            start.push_back(static_cast<int>(places.size()));
        }
    };
    /// Keeps L by rows for the way down and by columns for the way up, its unknowns by their height in the elimination
    /// tree: what has one height does not depend on each other, so a processor works on many at once. Each sum keeps
    /// its order, and so its bits.
    void keep(std::vector<std::vector<std::pair<int, S>>> const& columns, std::vector<int> const& parent);

    int n_{0};
    std::vector<int> order_; ///< place -> unknown
    Lists rows_, columns_;
    std::vector<S> inverse_pivot_;
    mutable std::vector<S> work_;
};

extern template class Ldlt<double>;
extern template class Ldlt<std::complex<double>>;

} // namespace gridspace::sim::emt

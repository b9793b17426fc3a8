// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/emt/division.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <functional>
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
    /// Factors the n x n matrix, and divides what a solution takes as `divide` says. Returns the unknowns at which an
    /// anchor was needed.
    std::vector<int> factor(int n, std::vector<Entry<S>> const& entries,
                            std::function<Division(EliminationTree const&)> const& divide = {});
    [[nodiscard]] Division const& division() const { return division_; }
    /// x := A^-1 b; allocates nothing. They may be the same.
    void solve(S const* b, S* x) const;
    void solve(S* x) const { solve(x, x); }
    /// The same in parts, with the same bits: first down() for each part, then rest(), then up() for each part. Those
    /// of the parts may run at the same time. Of `b` each reads its own unknowns.
    void down(int part, S const* b) const { down(first(part), first(part + 1), b); }
    void rest(S const* b, S* x) const;
    void up(int part, S* x) const { up(first(part), first(part + 1), x); }
    [[nodiscard]] int size() const { return n_; }
    /// Multiplications in a solve.
    [[nodiscard]] std::size_t work() const { return 2 * entries_ + static_cast<std::size_t>(n_); }

  private:
    using Line = std::vector<std::pair<int, S>>; ///< of a row or column, by place in the order of elimination
    /// Rows or columns of L without its diagonal, for one unit after the other. A place stands for all of a unit; its
    /// values follow each other, those of an unknown after those of another.
    struct Lists {
        std::vector<int> start, value_start; ///< by unit
        std::vector<int> places;
        std::vector<S> values;
    };
    /// Keeps L by rows for the way down and by columns for the way up, in units: three unknowns that follow each other
    /// and meet the same others (phases of a bus), or one. Units stand by their height in the elimination tree: what
    /// has one height does not depend on each other, so a processor works on many at once. Those of a part stand
    /// together. Each sum keeps its order, and so its bits.
    void keep(std::vector<Line> const& columns, std::vector<int> const& parent);
    void down(int begin, int end, S const* b) const;
    void up(int begin, int end, S* x) const;
    [[nodiscard]] int first(int part) const { return first_[static_cast<std::size_t>(part)]; }

    int n_{0};
    std::size_t entries_{0}; ///< of L without its diagonal
    std::vector<int> order_; ///< place -> unknown
    Division division_;
    std::vector<int> first_; ///< by part, the rest, and the end: the first unit
    std::vector<int> unit_;  ///< its first place
    std::vector<S> inside_;  ///< three by unit: entries of L among its unknowns
    Lists rows_, columns_;
    std::vector<S> inverse_pivot_;
    mutable std::vector<S> work_;
};

extern template class Ldlt<double>;
extern template class Ldlt<std::complex<double>>;

} // namespace gridspace::sim::emt

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/ldlt.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <utility>

namespace gridspace::sim::emt {
namespace {

/// Least pivot, of the diagonal entry as it was, that counts as one.
constexpr double kVanishing = 1e-11;

template <class S>
std::vector<int> minimum_degree(int n, std::vector<Entry<S>> const& entries) {
    std::vector<int> order(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) {
        order[static_cast<std::size_t>(i)] = i;
    }
    if (n <= 12) {
        return order;
    }
    std::vector<Eigen::Triplet<double>> pattern;
    for (int i = 0; i < n; ++i) {
        pattern.emplace_back(i, i, 1.0);
    }
    for (auto const& e : entries) {
        pattern.emplace_back(e.row, e.column, 1.0);
        pattern.emplace_back(e.column, e.row, 1.0);
    }
    Eigen::SparseMatrix<double> a(n, n);
    a.setFromTriplets(pattern.begin(), pattern.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> p;
    Eigen::AMDOrdering<int>{}(a, p);
    for (int i = 0; i < n; ++i) {
        order[static_cast<std::size_t>(i)] = p.indices()[i];
    }
    return order;
}

} // namespace

template <class S>
std::vector<int> Ldlt<S>::factor(int n, std::vector<Entry<S>> const& entries) {
    n_ = n;
    auto const size = static_cast<std::size_t>(n);
    order_ = minimum_degree(n, entries);
    std::vector<int> position(size);
    for (int k = 0; k < n; ++k) {
        position[static_cast<std::size_t>(order_[static_cast<std::size_t>(k)])] = k;
    }
    // Columns of the upper triangle in the new order, duplicates kept: they add up below.
    std::vector<std::vector<std::pair<int, S>>> upper(size);
    std::vector<S> diagonal(size, S{});
    for (auto const& e : entries) {
        int const i = position[static_cast<std::size_t>(e.row)], j = position[static_cast<std::size_t>(e.column)];
        if (i == j) {
            diagonal[static_cast<std::size_t>(i)] += e.value;
        } else {
            upper[static_cast<std::size_t>(std::max(i, j))].emplace_back(std::min(i, j), e.value);
        }
    }
    // Rows of L one after the other. `parent` is the elimination tree; the pattern of row k is what the entries of
    // column k reach on their way up the tree.
    std::vector<int> parent(size, -1), mark(size, -1), pattern(size), path(size);
    std::vector<std::vector<std::pair<int, S>>> columns(size);
    std::vector<S> y(size, S{}), pivot(size, S{});
    inverse_pivot_.assign(size, S{});
    std::vector<int> anchored;
    for (int k = 0; k < n; ++k) {
        auto const uk = static_cast<std::size_t>(k);
        mark[uk] = k;
        int top = n;
        for (auto const& [row, value] : upper[uk]) {
            y[static_cast<std::size_t>(row)] += value;
            int length = 0;
            for (int i = row; mark[static_cast<std::size_t>(i)] != k; i = parent[static_cast<std::size_t>(i)]) {
                if (parent[static_cast<std::size_t>(i)] < 0) {
                    parent[static_cast<std::size_t>(i)] = k;
                }
                path[static_cast<std::size_t>(length++)] = i;
                mark[static_cast<std::size_t>(i)] = k;
            }
            while (length > 0) {
                pattern[static_cast<std::size_t>(--top)] = path[static_cast<std::size_t>(--length)];
            }
        }
        S d = diagonal[uk];
        for (int p = top; p < n; ++p) {
            auto const i = static_cast<std::size_t>(pattern[static_cast<std::size_t>(p)]);
            S const yi = y[i];
            y[i] = S{};
            for (auto const& [row, value] : columns[i]) {
                y[static_cast<std::size_t>(row)] -= value * yi;
            }
            S const l = yi * inverse_pivot_[i];
            d -= l * yi;
            if (l != S{}) {
                columns[i].emplace_back(k, l);
            }
        }
        if (!(std::abs(d) > kVanishing * std::abs(diagonal[uk]))) {
            anchored.push_back(order_[uk]);
            d = diagonal[uk] != S{} ? diagonal[uk] : S(1);
        }
        pivot[uk] = d;
        inverse_pivot_[uk] = S(1) / d;
    }
    keep(columns, parent);
    work_.assign(size, S{});
    return anchored;
}

template <class S>
void Ldlt<S>::keep(std::vector<std::vector<std::pair<int, S>>> const& columns, std::vector<int> const& parent) {
    auto const size = static_cast<std::size_t>(n_);
    std::vector<int> height(size, 0), by_height(size), place(size);
    for (std::size_t k = 0; k < size; ++k) { // children come before their parents
        if (parent[k] >= 0) {
            int& above = height[static_cast<std::size_t>(parent[k])];
            above = std::max(above, height[k] + 1);
        }
        by_height[k] = static_cast<int>(k);
    }
    std::ranges::stable_sort(by_height, {}, [&](int k) { return height[static_cast<std::size_t>(k)]; });
    std::vector<int> order(size);
    std::vector<S> inverse(size);
    for (std::size_t p = 0; p < size; ++p) {
        auto const k = static_cast<std::size_t>(by_height[p]);
        place[k] = static_cast<int>(p);
        order[p] = order_[k];
        inverse[p] = inverse_pivot_[k];
    }
    order_ = std::move(order);
    inverse_pivot_ = std::move(inverse);
    std::vector<std::vector<std::pair<int, S>>> rows(size);
    columns_.clear(size);
    for (std::size_t k = 0; k < size; ++k) {
        for (auto const& [row, value] : columns[k]) {
            rows[static_cast<std::size_t>(row)].emplace_back(static_cast<int>(k), value);
        }
    }
    rows_.clear(size);
    for (int const k : by_height) {
        rows_.add(rows[static_cast<std::size_t>(k)], place);
        columns_.add(columns[static_cast<std::size_t>(k)], place);
    }
}

template <class S>
void Ldlt<S>::solve(S* x) const {
    S* const w = work_.data();
    int const* const order = order_.data();
    S const* const inverse = inverse_pivot_.data();
    auto const reduce = [w](Lists const& lists, int k, S wk) {
        int const* const places = lists.places.data();
        S const* const values = lists.values.data();
        for (int p = lists.start[static_cast<std::size_t>(k)]; p < lists.start[static_cast<std::size_t>(k) + 1]; ++p) {
            wk -= values[p] * w[places[p]];
        }
        return wk;
    };
    for (int k = 0; k < n_; ++k) {
        w[k] = reduce(rows_, k, x[order[k]]);
    }
    for (int k = n_ - 1; k >= 0; --k) {
        w[k] = reduce(columns_, k, w[k] * inverse[k]);
    }
    for (int k = 0; k < n_; ++k) {
        x[order[k]] = w[k];
    }
}

template class Ldlt<double>;
template class Ldlt<std::complex<double>>;

} // namespace gridspace::sim::emt

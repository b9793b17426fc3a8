// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/ldlt.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <initializer_list>
#include <ranges>
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
std::vector<int> Ldlt<S>::factor(int n, std::vector<Entry<S>> const& entries,
                                 std::function<Division(EliminationTree const&)> const& divide) {
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
    division_ = {};
    if (divide) {
        EliminationTree tree{order_, parent, {}};
        for (auto const& column : columns) {
            tree.work.push_back(2 * static_cast<double>(column.size()) + 1);
        }
        division_ = divide(tree);
    }
    keep(columns, parent);
    work_.assign(size, S{});
    return anchored;
}

namespace {

/// Whether `longer` is `head` and then the places of `shorter`.
template <class Line>
bool continues(Line const& longer, std::initializer_list<int> head, Line const& shorter) {
    auto const place = [](auto const& entry) { return entry.first; };
    return longer.size() == head.size() + shorter.size() &&
           std::ranges::equal(longer | std::views::take(head.size()), head, {}, place) &&
           std::ranges::equal(longer | std::views::drop(head.size()), shorter, {}, place, place);
}

/// Whether `longer` is the places of `shorter` and then `tail`.
template <class Line>
bool ends_with(Line const& longer, Line const& shorter, std::initializer_list<int> tail) {
    auto const place = [](auto const& entry) { return entry.first; };
    return longer.size() == shorter.size() + tail.size() &&
           std::ranges::equal(longer | std::views::take(shorter.size()), shorter, {}, place, place) &&
           std::ranges::equal(longer | std::views::drop(shorter.size()), tail, {}, place);
}

} // namespace

template <class S>
void Ldlt<S>::keep(std::vector<Line> const& columns, std::vector<int> const& parent) {
    auto const size = static_cast<std::size_t>(n_);
    std::vector<Line> rows(size);
    entries_ = 0;
    for (std::size_t k = 0; k < size; ++k) {
        for (auto const& [row, value] : columns[k]) {
            rows[static_cast<std::size_t>(row)].emplace_back(static_cast<int>(k), value);
            ++entries_;
        }
    }
    auto const part = [&](std::size_t k) { return division_.of(order_[k]); };
    auto const three = [&](std::size_t k) {
        int const a = static_cast<int>(k), b = a + 1, c = a + 2;
        return k + 2 < size && part(k) == part(k + 1) && part(k) == part(k + 2) &&
               ends_with(rows[k + 1], rows[k], {a}) && ends_with(rows[k + 2], rows[k], {a, b}) &&
               continues(columns[k + 1], {c}, columns[k + 2]) && continues(columns[k], {b, c}, columns[k + 2]);
    };
    // Units in the order of elimination: first unknown and width.
    struct Unit {
        std::size_t first, width;
        int part, height;
    };
    std::vector<Unit> units;
    std::vector<std::size_t> unit_of(size);
    for (std::size_t k = 0; k < size; k += units.back().width) {
        units.push_back({k, three(k) ? 3U : 1U, part(k), 0});
        std::fill_n(unit_of.begin() + static_cast<std::ptrdiff_t>(k), units.back().width, units.size() - 1);
    }
    for (Unit const& u : units) { // children come before their parents
        if (int const above = parent[u.first + u.width - 1]; above >= 0) {
            int& height = units[unit_of[static_cast<std::size_t>(above)]].height;
            height = std::max(height, u.height + 1);
        }
    }
    std::ranges::stable_sort(units, {}, [](Unit const& u) { return std::pair{u.part, u.height}; });
    std::vector<int> place(size), order;
    std::vector<S> inverse;
    unit_.assign(1, 0);
    first_.assign(static_cast<std::size_t>(division_.parts) + 2, static_cast<int>(units.size()));
    for (std::size_t u = 0; u < units.size(); ++u) {
        for (std::size_t k = units[u].first; k < units[u].first + units[u].width; ++k) {
            place[k] = static_cast<int>(order.size());
            order.push_back(order_[k]);
            inverse.push_back(inverse_pivot_[k]);
        }
        unit_.push_back(static_cast<int>(order.size()));
        int& begin = first_[static_cast<std::size_t>(units[u].part)];
        begin = std::min(begin, static_cast<int>(u));
    }
    for (std::size_t p = first_.size() - 1; p-- > 0;) { // of a part without units: where the next one begins
        first_[p] = std::min(first_[p], first_[p + 1]);
    }
    order_ = std::move(order);
    inverse_pivot_ = std::move(inverse);
    rows_ = columns_ = {};
    inside_.assign(3 * units.size(), S{});
    auto const add = [&](Lists& lists, Unit const& u, std::vector<Line> const& lines, std::size_t skip_first) {
        // What the unknown with the shortest line has, all have.
        Line const& shared = lines[skip_first == 0 ? u.first : u.first + u.width - 1];
        lists.start.push_back(static_cast<int>(lists.places.size()));
        lists.value_start.push_back(static_cast<int>(lists.values.size()));
        for (auto const& [at, value] : shared) {
            lists.places.push_back(place[static_cast<std::size_t>(at)]);
        }
        for (std::size_t i = 0; i < u.width; ++i) {
            Line const& line = lines[u.first + i];
            std::size_t const from = skip_first == 0 ? 0 : line.size() - shared.size();
            for (std::size_t k = 0; k < shared.size(); ++k) {
                lists.values.push_back(line[from + k].second);
            }
        }
    };
    for (std::size_t u = 0; u < units.size(); ++u) {
        std::size_t const first = units[u].first;
        add(rows_, units[u], rows, 0);
        add(columns_, units[u], columns, 1);
        if (units[u].width == 3) {
            inside_[3 * u] = columns[first][0].second;
            inside_[3 * u + 1] = columns[first][1].second;
            inside_[3 * u + 2] = columns[first + 1][0].second;
        }
    }
    rows_.start.push_back(static_cast<int>(rows_.places.size()));
    columns_.start.push_back(static_cast<int>(columns_.places.size()));
}

namespace {

/// What is left of a sum once what is known already is taken off.
template <class S>
S reduced(int const* places, S const* values, int count, S const* w, S sum) {
    for (int p = 0; p < count; ++p) {
        sum -= values[p] * w[places[p]];
    }
    return sum;
}

} // namespace

template <class S>
void Ldlt<S>::down(int begin, int end, S const* b) const {
    S* const w = work_.data();
    int const *const order = order_.data(), *const unit = unit_.data(), *const start = rows_.start.data(),
                     *const value_start = rows_.value_start.data(), *const all_places = rows_.places.data();
    S const *const all_values = rows_.values.data(), *const all_inside = inside_.data();
    for (int u = begin; u < end; ++u) {
        int const k = unit[u], count = start[u + 1] - start[u];
        int const* const places = all_places + start[u];
        S const* const values = all_values + value_start[u];
        if (unit[u + 1] - k == 1) {
            w[k] = reduced(places, values, count, w, b[order[k]]);
            continue;
        }
        S x0 = b[order[k]], x1 = b[order[k + 1]], x2 = b[order[k + 2]];
        for (int p = 0; p < count; ++p) {
            S const known = w[places[p]];
            x0 -= values[p] * known;
            x1 -= values[count + p] * known;
            x2 -= values[2 * count + p] * known;
        }
        S const* const inside = all_inside + 3 * u;
        x1 -= inside[0] * x0;
        x2 -= inside[1] * x0;
        x2 -= inside[2] * x1;
        w[k] = x0;
        w[k + 1] = x1;
        w[k + 2] = x2;
    }
}

template <class S>
void Ldlt<S>::up(int begin, int end, S* x) const {
    S* const w = work_.data();
    int const *const order = order_.data(), *const unit = unit_.data(), *const start = columns_.start.data(),
                     *const value_start = columns_.value_start.data(), *const all_places = columns_.places.data();
    S const *const all_values = columns_.values.data(), *const all_inside = inside_.data(),
                   *const inverse = inverse_pivot_.data();
    for (int u = end - 1; u >= begin; --u) {
        int const k = unit[u], count = start[u + 1] - start[u];
        int const* const places = all_places + start[u];
        S const* const values = all_values + value_start[u];
        if (unit[u + 1] - k == 1) {
            x[order[k]] = w[k] = reduced(places, values, count, w, w[k] * inverse[k]);
            continue;
        }
        S const* const inside = all_inside + 3 * u;
        S const x2 = reduced(places, values + 2 * count, count, w, w[k + 2] * inverse[k + 2]);
        S const x1 = reduced(places, values + count, count, w, w[k + 1] * inverse[k + 1] - inside[2] * x2);
        S const x0 = reduced(places, values, count, w, w[k] * inverse[k] - inside[0] * x1 - inside[1] * x2);
        x[order[k]] = w[k] = x0;
        x[order[k + 1]] = w[k + 1] = x1;
        x[order[k + 2]] = w[k + 2] = x2;
    }
}

template <class S>
void Ldlt<S>::rest(S const* b, S* x) const {
    int const begin = first_[first_.size() - 2];
    down(begin, first_.back(), b);
    up(begin, first_.back(), x);
}

template <class S>
void Ldlt<S>::solve(S const* b, S* x) const {
    down(0, first_.back(), b);
    up(0, first_.back(), x);
}

template class Ldlt<double>;
template class Ldlt<std::complex<double>>;

} // namespace gridspace::sim::emt

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/nodal_system.hpp"

#include <algorithm>
#include <cmath>

/// The system of a switch state that differs from a known one by a few fault phases or cores only: A' = A + U D U', so
/// A'^-1 = A^-1 - W C W' with W = A^-1 U and C = (I + D U'W)^-1 D  [Woodbury 1950, in the form for a singular D].
namespace gridspace::sim::emt {
namespace {

constexpr std::size_t kMax = NodalSystem::Update::kMaxRank;
using Small = std::array<std::array<double, kMax>, kMax>;

/// Below this share of the largest, a pivot says that the change cuts something off from earth.
constexpr double kMinPivot = 1e-9;

/// B := A^-1 B by elimination with pivoting; false when A is singular to working accuracy.
bool solve_small(Small& a, Small& b, std::size_t n) {
    for (std::size_t c = 0; c < n; ++c) {
        std::size_t pivot = c;
        double largest = 0;
        for (std::size_t r = c; r < n; ++r) {
            pivot = std::abs(a[r][c]) > std::abs(a[pivot][c]) ? r : pivot;
        }
        for (std::size_t r = 0; r < n; ++r) {
            for (std::size_t k = 0; k < n; ++k) {
                largest = std::max(largest, std::abs(a[r][k]));
            }
        }
        if (!(std::abs(a[pivot][c]) > kMinPivot * largest)) {
            return false;
        }
        std::swap(a[c], a[pivot]);
        std::swap(b[c], b[pivot]);
        for (std::size_t r = 0; r < n; ++r) {
            if (r == c) {
                continue;
            }
            double const factor = a[r][c] / a[c][c];
            for (std::size_t k = 0; k < n; ++k) {
                a[r][k] -= factor * a[c][k];
                b[r][k] -= factor * b[c][k];
            }
        }
    }
    for (std::size_t r = 0; r < n; ++r) {
        for (std::size_t k = 0; k < n; ++k) {
            b[r][k] /= a[r][r];
        }
    }
    return true;
}

/// What changes: columns of U (slots and weights) and D.
struct Change {
    std::vector<std::vector<std::pair<int, double>>> columns;
    Small d{};
};

/// False when it is too much, or touches an ideal source.
bool difference(Circuit const& c, NodalSystem const& base, SwitchBits const& bits, double h, Change& out) {
    Topology const& t = base.topology;
    auto const slot = [&](int node) { return t.slot[static_cast<std::size_t>(node)]; };
    auto const driven = [&](int s) { return s > t.earth(); };
    for (std::size_t f = 0; f < c.faults.size(); ++f) {
        if (bits.faulted[f] == base.bits.faulted[f]) {
            continue;
        }
        if (out.columns.size() + 3 > kMax) {
            return false;
        }
        Conductances const now = fault_conductances(c.faults[f], bits.faulted[f]);
        Conductances const before = fault_conductances(c.faults[f], base.bits.faulted[f]);
        std::size_t const first = out.columns.size();
        for (int k = 0; k < 3; ++k) {
            int const s = slot(c.faults[f].node + k);
            if (driven(s)) {
                return false;
            }
            out.columns.push_back({{s, 1.0}});
        }
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                out.d[first + i][first + j] = now[i][j] - before[i][j];
            }
        }
    }
    for (std::size_t i = 0; i < c.cores.size(); ++i) {
        bool const now = bits.segment[i] == 0, before = base.bits.segment[i] == 0;
        if (now == before) {
            continue;
        }
        if (out.columns.size() + 1 > kMax) {
            return false;
        }
        double const unsaturated = h / (2 * c.cores[i].l), saturated = h / (2 * c.cores[i].l_air);
        std::size_t const at = out.columns.size();
        out.d[at][at] = now ? unsaturated - saturated : saturated - unsaturated;
        out.columns.emplace_back();
        for (std::size_t k = 0; k < 4; ++k) {
            int const s = slot(c.cores[i].nodes[k]);
            if (driven(s) && c.cores[i].weights[k] != 0) {
                return false;
            }
            out.columns.back().emplace_back(s, c.cores[i].weights[k]);
        }
    }
    return true;
}

} // namespace

std::shared_ptr<NodalSystem> update_system(Circuit const& c, std::shared_ptr<NodalSystem> const& base,
                                           SwitchBits const& bits) {
    if (base->update || !base->anchored.empty() || base->bits.closed != bits.closed) {
        return nullptr;
    }
    Change change;
    if (!difference(c, *base, bits, base->h, change)) {
        return nullptr;
    }
    auto const n = static_cast<std::size_t>(base->topology.unknowns);
    std::size_t const rank = change.columns.size();
    NodalSystem::Update update;
    update.base = base;
    update.rank = rank;
    std::vector<double> b(n);
    for (std::size_t k = 0; k < rank; ++k) {
        std::fill(b.begin(), b.end(), 0.0);
        for (auto const& [slot, weight] : change.columns[k]) {
            if (slot < base->topology.unknowns) {
                b[static_cast<std::size_t>(slot)] += weight;
            }
        }
        update.w.resize((k + 1) * n);
        base->solve(b.data(), update.w.data() + k * n);
    }
    Small left{};
    for (std::size_t i = 0; i < rank; ++i) {
        for (std::size_t j = 0; j < rank; ++j) {
            double sum = i == j ? 1 : 0;
            for (std::size_t k = 0; k < rank; ++k) {
                double m = 0; // (U'W)_kj
                for (auto const& [slot, weight] : change.columns[k]) {
                    m += slot < base->topology.unknowns ? weight * update.w[j * n + static_cast<std::size_t>(slot)] : 0;
                }
                sum += change.d[i][k] * m;
            }
            left[i][j] = sum;
        }
    }
    update.c = change.d;
    if (!solve_small(left, update.c, rank)) {
        return nullptr;
    }
    auto out = std::make_shared<NodalSystem>(*base);
    out->inverse.clear();
    out->inverse.shrink_to_fit();
    out->factors = {};
    out->bits = bits;
    update.columns = std::move(change.columns);
    out->update = std::move(update);
    return out;
}

void NodalSystem::Update::subtract(std::array<double, kMaxRank> const& seen, double* x) const {
    if (rank == 0) { // cores that are saturated the other way round: the matrix is the same
        return;
    }
    auto const n = w.size() / rank;
    for (std::size_t i = 0; i < rank; ++i) {
        double s = 0;
        for (std::size_t k = 0; k < rank; ++k) {
            s += c[i][k] * seen[k];
        }
        double const* const column = w.data() + i * n;
        for (std::size_t r = 0; r < n; ++r) {
            x[r] -= column[r] * s;
        }
    }
}

} // namespace gridspace::sim::emt

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/nodal_solver.hpp"

#include "sim/powerflow/sparse_lu.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace gridspace::sim {
namespace {

Eigen::SparseMatrix<std::complex<double>> matrix_of(NodalNetwork const& n, double anchor_share) {
    std::vector<Eigen::Triplet<std::complex<double>>> places;
    std::vector<double> own(static_cast<std::size_t>(n.nodes), 0.0);
    for (auto const& e : n.admittances) {
        if (!n.held.contains(e.row())) {
            places.push_back(e);
            own[static_cast<std::size_t>(e.row())] += e.row() == e.col() ? std::abs(e.value()) : 0;
        }
    }
    std::copy_if(n.of_loads.begin(), n.of_loads.end(), std::back_inserter(places),
                 [&](auto const& e) { return !n.held.contains(e.row()); });
    for (int k = 0; k < n.nodes; ++k) {
        places.emplace_back(k, k, n.held.contains(k) ? 1 : anchor_share * own[static_cast<std::size_t>(k)]);
    }
    Eigen::SparseMatrix<std::complex<double>> y(n.nodes, n.nodes);
    y.setFromTriplets(places.begin(), places.end());
    return y;
}

} // namespace

Result<NodalSolution> solve_nodal(NodalNetwork const& n, NodalCurrents const& currents, NodalOptions const& options) {
    Eigen::SparseLU<Eigen::SparseMatrix<std::complex<double>>> factors{matrix_of(n, options.anchor_share)};
    if (factors.info() != Eigen::Success) {
        return fail(ExitCode::usage, "the three-phase admittance matrix is singular",
                    "is a part of the network without any element?");
    }
    Eigen::VectorXcd driven = Eigen::VectorXcd::Zero(n.nodes);
    for (auto const& [node, current] : n.driven) {
        driven[node] += current;
    }
    auto const hold = [&](Eigen::VectorXcd& rhs) {
        for (auto const& [node, voltage] : n.held) {
            rhs[node] = voltage;
        }
    };
    hold(driven);
    NodalSolution out;
    out.v = factors.solve(driven);
    for (out.iterations = 1; out.iterations <= options.max_iterations; ++out.iterations) {
        Eigen::VectorXcd i = driven;
        currents(out.v, i);
        hold(i);
        Eigen::VectorXcd const next = factors.solve(i);
        out.change_pu = 0;
        for (std::size_t k = 0; k < n.base_v.size(); ++k) {
            if (n.base_v[k] > 0) {
                auto const node = static_cast<Eigen::Index>(k);
                out.change_pu = std::max(out.change_pu, std::abs(next[node] - out.v[node]) / n.base_v[k]);
            }
        }
        out.v = next;
        if (!(out.change_pu < 1e3)) {
            break;
        }
        if (out.change_pu < options.tolerance_pu) {
            return out;
        }
    }
    return fail(
        ExitCode::usage,
        fmt::format("the three-phase power flow does not converge: voltages still move by {:.3g} p.u.", out.change_pu),
        "the loads are more than the network can carry, an impedance is wrong, or loads of constant power lie "
        "behind windings that nothing connects to earth");
}

} // namespace gridspace::sim

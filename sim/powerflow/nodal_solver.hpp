// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <complex>
#include <functional>
#include <map>
#include <utility>
#include <vector>

namespace gridspace::sim {

/// Nodes, and what is linear between them and earth.
struct NodalNetwork {
    using Complex = std::complex<double>;
    int nodes{0};
    std::vector<Eigen::Triplet<Complex>> admittances; ///< S
    std::vector<Eigen::Triplet<Complex>> of_loads;    ///< S, beside those: what of the loads is linear
    std::map<int, Complex> held;                      ///< V, of nodes that ideal sources hold
    std::vector<std::pair<int, Complex>> driven;      ///< A into a node, of sources behind impedances
    std::vector<double> base_v;                       ///< of a node, for its change; 0: it does not count
};

struct NodalOptions {
    double tolerance_pu{1e-9};
    int max_iterations{500};
    /// What nothing connects to earth still needs a potential: each node has an earth connection of this share of its
    /// own admittance.
    double anchor_share{1e-10};
};

struct NodalSolution {
    int iterations{0};
    double change_pu{0}; ///< of the last iteration
    Eigen::VectorXcd v;  ///< V
};

/// Adds the currents into the nodes, A, that are not linear in the voltages.
using NodalCurrents = std::function<void(Eigen::VectorXcd const& v, Eigen::VectorXcd& i)>;

/// Voltages at which the currents of all nodes are none: fixed point on the factored nodal admittance [Chen et al.,
/// IEEE Trans. Power Deliv. 6(3), 1991], from the voltages without `currents`. Fails when the matrix is singular or the
/// voltages do not settle; the message says by how much they still move.
[[nodiscard]] Result<NodalSolution> solve_nodal(NodalNetwork const& network, NodalCurrents const& currents,
                                                NodalOptions const& options);

} // namespace gridspace::sim

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/problem.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cmath>

namespace gridspace::sim {

PowerFlowStart linear_start(PowerFlowProblem const& problem) {
    PowerFlowStart start;
    constexpr std::size_t kHeld = static_cast<std::size_t>(-1);
    std::vector<std::size_t> unknown(problem.nodes.size(), kHeld);
    std::size_t count = 0;
    for (std::size_t i = 0; i < problem.nodes.size(); ++i) {
        PowerFlowProblem::Node const& node = problem.nodes[i];
        start.v.push_back(node.v);
        start.angle.push_back(node.angle);
        if (node.kind == NodeKind::pv || node.kind == NodeKind::pq) {
            unknown[i] = count++;
        }
    }
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd power = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(count));
    auto const at = [&](std::size_t node) { return static_cast<Eigen::Index>(unknown[node]); };
    for (std::size_t i = 0; i < problem.nodes.size(); ++i) {
        if (unknown[i] != kHeld) {
            power[at(i)] += problem.nodes[i].p;
        }
    }
    for (PowerFlowProblem::BusLoad const& load : problem.loads) {
        if (unknown[load.node] != kHeld) {
            power[at(load.node)] -= load.p;
        }
    }
    for (Branch const& b : problem.branches) {
        double const weight = std::abs(b.ft);
        if (weight == 0 || b.tf == Complex{}) {
            continue;
        }
        double const lead = lead_of(b);
        for (auto const& [own, other, turn] : {std::tuple{b.from, b.to, lead}, std::tuple{b.to, b.from, -lead}}) {
            if (unknown[own] == kHeld) {
                continue;
            }
            entries.emplace_back(at(own), at(own), weight);
            power[at(own)] -= weight * turn;
            if (unknown[other] != kHeld) {
                entries.emplace_back(at(own), at(other), -weight);
            } else {
                power[at(own)] += weight * problem.nodes[other].angle;
            }
        }
    }
    auto const size = static_cast<Eigen::Index>(count);
    Eigen::SparseMatrix<double> laplacian(size, size);
    laplacian.setFromTriplets(entries.begin(), entries.end());
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors{laplacian};
    if (factors.info() == Eigen::Success) {
        Eigen::VectorXd const angle = factors.solve(power);
        for (std::size_t i = 0; i < problem.nodes.size(); ++i) {
            if (unknown[i] != kHeld) {
                start.angle[i] = angle[at(i)];
            }
        }
    }
    return start;
}

} // namespace gridspace::sim

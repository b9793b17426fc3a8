// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/powerflow/problem.hpp"

#include <string>
#include <vector>

namespace gridspace::sim {

struct SearchOutcome {
    NewtonOutcome solution;          ///< the one to believe; not converged: the best attempt
    std::vector<std::string> doubts; ///< what an operator would not believe of it, with numbers
    /// Where there is no solution: followed from no load, the share of all powers that still has one, and the voltages
    /// there.
    double reached{0};
    std::vector<double> v_reached;
};

/// What an operator would not believe of a solution: voltages, angles across a branch, losses.
[[nodiscard]] std::vector<std::string> doubts_about(Network const& network, PowerFlowProblem const& problem,
                                                    NewtonOutcome const& solution);

/// Looks for the solution from several starts, and stops at the first without doubts: the solution that came with the
/// network, flat voltages, the angles of the linear power flow, and a path from no load to all powers. Of solutions
/// with doubts the one with the fewest is taken, the earliest of equals.
[[nodiscard]] SearchOutcome search(Network const& network, PowerFlowProblem const& problem,
                                   PowerFlowOptions const& options);

} // namespace gridspace::sim

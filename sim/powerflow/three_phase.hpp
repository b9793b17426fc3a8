// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/network/network.hpp"
#include "sim/powerflow/branch.hpp"

#include <array>
#include <vector>

namespace gridspace::sim {

/// Phasors of phases a, b, c: volts to earth, or amperes.
using Phases = std::array<Complex, 3>;

/// Whether phases differ: line types with phase impedances, or loads by phase.
[[nodiscard]] bool is_unbalanced(Network const& network);

struct ThreePhaseFlow {
    struct Branch {
        std::size_t element{0}; ///< of two_ports(network)
        Phases from{}, to{};    ///< currents into the branch, A
    };
    int iterations{0};
    double change_pu{0};       ///< of the last iteration
    std::vector<Phases> buses; ///< V, r.m.s.
    std::vector<Branch> branches;
};

struct ThreePhaseOptions {
    double tolerance_pu{1e-9};
    int max_iterations{500};
    double hours{0};             ///< time at which profiles are read
    double start_hour_of_day{0}; ///< of simulated time 0
};

/// Unbalanced power flow of a distribution network: phase impedance matrices, transformers with their connections,
/// loads by phase between phase and earth; converters inject currents of positive sequence. Sources and slack
/// generators hold the voltage. Fixed point on the factored nodal admittance [Chen et al., IEEE Trans. Power Deliv.
/// 6(3), 1991]. Fails when it does not converge, or on machines and regulated generators.
[[nodiscard]] Result<ThreePhaseFlow> solve_three_phase(Network const& network, SwitchState const& state,
                                                       ThreePhaseOptions const& options = {});

} // namespace gridspace::sim

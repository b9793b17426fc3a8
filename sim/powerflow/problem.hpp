// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/powerflow/power_flow.hpp"

#include <optional>
#include <vector>

namespace gridspace::sim {

enum class NodeKind { slack, pv, pq, dead };

/// Where an iteration begins, by node: p.u. and radians.
struct PowerFlowStart {
    std::vector<double> v, angle;
};

/// The power flow as equations see it: nodes, p.u. on the base. The first nodes are the buses; the others are the ideal
/// sources behind impedances.
struct PowerFlowProblem {
    struct Node {
        NodeKind kind{NodeKind::pq};
        double v{1}, angle{0}; ///< held or initial
        double p{0}, q{0};     ///< generation, p.u. (q: pq nodes only)
        double q_min{-1e30}, q_max{1e30};
    };
    struct BusLoad {
        std::size_t node{0};
        VoltageDependent const* load{nullptr};
        double p{0}, q{0}; ///< at 1 p.u., scaled
    };
    std::vector<Node> nodes;
    std::vector<Branch> branches; ///< with the source impedances at the end
    std::vector<Complex> shunts;  ///< admittance by node
    std::vector<BusLoad> loads;
    /// What an element at one bus holds there; by element, in the order of one_ports(network).
    struct Unit {
        enum class Holds { nothing, voltage_and_angle, power_and_voltage } holds{Holds::nothing};
        std::size_t node{0}; ///< its bus, or the ideal source behind its impedance
        Complex kva{}; ///< into the network: what it gives or is to give; at nominal voltage where it is an admittance
        bool admittance{false};
        std::optional<std::size_t> load{}; ///< of `loads`
        double rating_kva{0};
        bool keeps_alive{false};
    };
    std::vector<Unit> units;
    std::optional<PowerFlowStart> given; ///< a solution that came with the network
};

[[nodiscard]] PowerFlowProblem make_problem(Network const& network, SwitchState const& state,
                                            PowerFlowOptions const& options);

struct NewtonOutcome {
    bool converged{false};
    bool singular{false};
    int iterations{0};
    double mismatch{0};
    std::size_t worst_node{0};
    std::vector<double> v, angle;
    std::vector<Complex> injection; ///< net, computed, p.u.
};

/// Solves with all loads and generation multiplied by `scale`, from the nodes' own voltages or from `start`.
[[nodiscard]] NewtonOutcome newton(PowerFlowProblem const& problem, PowerFlowOptions const& options, double scale = 1,
                                   PowerFlowStart const* start = nullptr);

/// Angles that a lossless network would have under its power, phase shifters included, in meshes as well: one linear
/// system [Stott, Jardim and Alsac 2009, "DC power flow revisited"].
[[nodiscard]] PowerFlowStart linear_start(PowerFlowProblem const& problem);

} // namespace gridspace::sim

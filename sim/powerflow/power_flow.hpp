// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/network/network.hpp"
#include "sim/powerflow/branch.hpp"

#include <optional>
#include <string>
#include <vector>

namespace gridspace::sim {

struct PowerFlowOptions {
    double tolerance_pu{1e-10}; ///< largest power mismatch of a bus, on the network's base
    int max_iterations{40};
    bool enforce_q_limits{false}; ///< a generator at its limit gives up its voltage
    double hours{0};              ///< time at which profiles are read
    double start_hour_of_day{0};  ///< of simulated time 0
};

struct PowerFlow {
    struct BusValue {
        Complex v;                 ///< p.u.; |v| and angle
        double p_kw{0}, q_kvar{0}; ///< net injection: generation minus load
    };
    struct BranchValue {
        std::size_t element{0};              ///< of two_ports(network)
        double p_from_kw{0}, q_from_kvar{0}; ///< into the branch at its `from` end
        double p_to_kw{0}, q_to_kvar{0};     ///< into the branch at its `to` end
    };
    struct UnitValue {
        double p_kw{0}, q_kvar{0}; ///< injected at the terminals
    };
    int iterations{0};
    double mismatch_pu{0};
    std::vector<BusValue> buses;       ///< by bus of the network
    std::vector<BranchValue> branches; ///< two-ports in service
    std::vector<UnitValue> units;      ///< what each of one_ports(network) gives; those that share a bus: equally
    double losses_kw{0};
    std::vector<std::string> doubts; ///< what an operator would not believe of the solution, with numbers
};

/// Balanced power flow by Newton-Raphson in polar coordinates with voltage-dependent loads
/// [Tinney and Hart 1967; MATPOWER User's Manual, power flow]. A source with an impedance is an ideal one behind it. A
/// machine holds its power and terminal voltage; the largest machine of an island without a source or slack generator
/// holds the angle instead of the power. Several starts are tried (search.hpp). Fails with the bus at which most power
/// does not balance, and the share of all powers that has a solution.
[[nodiscard]] Result<PowerFlow> solve_power_flow(Network const& network, SwitchState const& state,
                                                 PowerFlowOptions const& options = {});

} // namespace gridspace::sim

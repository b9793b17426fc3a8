// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/powerflow/power_flow.hpp"

#include <string>

namespace gridspace::sim {

/// The network and its solution as a MATPOWER case, format version 2 [MATPOWER User's Manual, appendix B]. Buses are
/// numbered from 1 in the network's order, their names are in mpc.bus_name; an ideal source behind an impedance is a
/// further bus, the impedance a branch. Loads stand with what they draw in the solution, generation is one row a bus. A
/// two-port that MATPOWER's branch cannot be (magnetising losses, other charging at one end) leaves the rest in the
/// shunts of its buses, so that the admittance matrix is the same.
[[nodiscard]] std::string to_matpower(Network const& network, SwitchState const& state, PowerFlowOptions const& options,
                                      PowerFlow const& solution);

} // namespace gridspace::sim

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/network/network.hpp"

#include <cstddef>
#include <limits>
#include <vector>

namespace gridspace::sim {

/// Which switches at line ends are closed now, and which two-ports are in service; starts as the network file says.
struct SwitchState {
    explicit SwitchState(Network const& network);
    std::vector<bool> switch_closed; ///< by switch, in the order of the list
    std::vector<bool> out;           ///< by two-port: taken out of service as a whole
    [[nodiscard]] Ends closed(Network const& network, Ref const& line) const;
};

/// A two-port in positive sequence.
struct Branch : Admittances {
    static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
    std::size_t element{kNone}; ///< of two_ports(network); none: the impedance of a source
    std::size_t from{0}, to{0}; ///< bus indices
};

/// The two-ports in service. A line that is open at one end still draws its charging current from the other.
[[nodiscard]] std::vector<Branch> branches(Network const& network, SwitchState const& state);

/// By how much the voltage at `to` leads that at `from` without load, radians: minus the shift of a transformer.
[[nodiscard]] double lead_of(Branch const& b);

} // namespace gridspace::sim

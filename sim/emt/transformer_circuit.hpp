// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/emt/circuit.hpp"
#include "sim/network/network.hpp"

namespace gridspace::sim::emt {

/// One side of a transformer in a circuit.
struct Winding3 {
    int node{0}; ///< triple of its terminals
    sim::Winding connection{sim::Winding::wye_grounded};
    double voltage_v{0}; ///< of its bus, line to line
    std::string name;
};

/// Adds a two-winding transformer: leakage at the `to` side, magnetising (with saturation) at the `from` side, as in
/// the power flow. Fails when its phase shift is not one that its windings can make.
[[nodiscard]] Result<void> add_transformer(Circuit& circuit, Transformer const& transformer, Winding3 const& from,
                                           Winding3 const& to, int from_switch, int to_switch);

} // namespace gridspace::sim::emt

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/circuit/circuit.hpp"
#include "sim/emt/ldlt.hpp"

#include <complex>
#include <vector>

namespace gridspace::sim::emt {

/// Which poles are closed, fault phases on, cores saturated: what the nodal matrix depends on besides the step.
struct SwitchBits {
    std::vector<std::array<bool, 3>> closed;  ///< by switch
    std::vector<std::array<bool, 3>> faulted; ///< by fault
    std::vector<signed char> segment;         ///< by core: -1, 0, 1
    friend bool operator==(SwitchBits const&, SwitchBits const&) = default;
};

/// Nodes that closed poles make one share a slot. Slots [0, unknowns) are solved for; then comes earth, then the nodes
/// of ideal voltage sources. Behind them are more slots of earth, for elements.
struct Topology {
    static constexpr int kEarths = 24;
    std::vector<int> slot; ///< by node
    int unknowns{0}, slots{0};
    [[nodiscard]] int earth() const { return unknowns; }
    /// Slots, with the further ones of earth.
    [[nodiscard]] std::size_t places() const { return static_cast<std::size_t>(slots) + kEarths; }
};

/// Fails when poles join two voltage sources, or a source with earth.
[[nodiscard]] Result<Topology> make_topology(Circuit const& circuit, SwitchBits const& bits);

/// Conductances between the phases of a fault and earth, with the phases that are on.
using Conductances = std::array<std::array<double, 3>, 3>;
[[nodiscard]] Conductances fault_conductances(FaultBranch const& fault, std::array<bool, 3> const& on);

/// What every element conducts: real for a time step, complex for the steady state.
template <class S>
struct Admittances {
    std::vector<PhaseMatrixOf<S>> rl, capacitors, norton, bergeron, marti;
    /// What couples the ends of travelling-wave lines: in the steady state, not within a step.
    std::vector<PhaseMatrixOf<S>> bergeron_cross, marti_cross;
    std::vector<S> windings, cores;
    std::vector<Matrix3Of<S>> coupled;
};

template <class S>
struct Assembly {
    std::vector<Entry<S>> matrix;   ///< among unknowns, row <= column
    std::vector<Entry<S>> coupling; ///< row unknown, column slot of a source node
};
template <class S>
[[nodiscard]] Assembly<S> assemble(Circuit const& circuit, Topology const& topology, SwitchBits const& bits,
                                   Admittances<S> const& y);

} // namespace gridspace::sim::emt

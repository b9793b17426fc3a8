// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/circuit/circuit.hpp"
#include "sim/emt/topology.hpp"

#include <algorithm>
#include <complex>
#include <string>
#include <vector>

namespace gridspace::sim::emt {

/// Resistance and inductance behind an element with states of its own.
struct NortonImpedance {
    PhaseMatrix r, l;
};

/// A mode of a circuit with its losses: v exp(s t), v by unknown.
struct Damped {
    std::complex<double> s;
    std::vector<std::complex<double>> v;
};

/// Of a coupled branch.
[[nodiscard]] inline bool no_inductance(Matrix3 const& l) {
    return std::ranges::all_of(
        l, [](auto const& row) { return std::ranges::all_of(row, [](double x) { return x == 0; }); });
}

/// The owners of the elements that hold most of the energy of a mode, the largest share first.
[[nodiscard]] std::vector<std::string> mode_elements(Circuit const& circuit, Topology const& topology,
                                                     std::vector<NortonImpedance> const& norton, Damped const& mode);

} // namespace gridspace::sim::emt

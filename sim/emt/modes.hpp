// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/circuit/circuit.hpp"
#include "sim/emt/topology.hpp"

#include <optional>
#include <string>
#include <vector>

namespace gridspace::sim::emt {

/// A natural oscillation of a circuit: v(t) = exp(-decay t) cos(2 pi frequency t).
struct Mode {
    double frequency_hz{0};
    double decay_per_s{0};
    std::vector<std::string> elements; ///< that hold most of its energy, the largest share first
};

/// What fastest_mode() looks at.
struct ModeSearch {
    std::vector<double> peak_v; ///< nominal voltage by node, phase to earth
    /// Capacitances that give less reactive power than this at a node (per phase, at nominal voltage) are left out:
    /// they cannot move the voltage of anything else.
    double least_var{0};
};

/// The fastest oscillation of a switch state, nothing when none rings. Frequencies without losses come from the
/// inductive and the capacitive nodal matrix, the largest by Lanczos; each is then corrected for all resistances by
/// Newton's method on det Y(s) = 0, Y the nodal admittance of the whole circuit. What falls to a tenth within a period
/// does not count as ringing. Travelling-wave lines are their surge impedances, cores unsaturated, injected currents
/// nothing. Fails as make_topology() does. Deterministic. [generalised symmetric problem: Parlett, The Symmetric
/// Eigenvalue Problem, 1998, ch. 13 and 15]
[[nodiscard]] Result<std::optional<Mode>> fastest_mode(Circuit const& circuit, SwitchBits const& bits,
                                                       ModeSearch const& search);

/// All poles closed, or as they are at the start; no fault.
[[nodiscard]] SwitchBits switch_state(Circuit const& circuit, bool all_closed);

} // namespace gridspace::sim::emt

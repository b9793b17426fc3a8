// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/engine/action.hpp"
#include "sim/powerflow/branch.hpp"

#include <set>
#include <string>

namespace gridspace::sim::phasor {

/// Negative and zero sequence impedance between a place and earth, p.u. on the base of that place's voltage.
struct SequenceImpedances {
    Complex z2, z0;
};

/// What the negative and the zero sequence network show at a fault. Lines by their sequence values; transformers by
/// their connections; machines by the mean of their subtransient reactances and by x0; sources by their impedances;
/// loads as earthed stars of their nominal power, as in waveforms; converters not at all. `out` are elements that were
/// disconnected.
[[nodiscard]] Result<SequenceImpedances> sequence_impedances(Network const& network, SwitchState const& switches,
                                                             std::set<std::string> const& out, ApplyFault const& fault);

/// What an unbalanced fault is for the positive sequence: an impedance to earth [Anderson, Analysis of Faulted Power
/// Systems, 1973, ch. 3]. The resistance r is between each faulted phase and the common point. All p.u.
[[nodiscard]] Complex positive_sequence_fault(FaultType type, SequenceImpedances const& z, double r);

} // namespace gridspace::sim::phasor

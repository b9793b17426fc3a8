// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/element.hpp"

/// Mistakes that several kinds of element look for.
namespace gridspace::sim::elements {

/// Below this share of the base impedance the current of a branch is a difference of voltages that agree in nearly all
/// of their digits: rounding errors would be amperes.
constexpr double kMinImpedancePu = 1e-10;

/// Impedances in ohm, positive and zero sequence, of something at a bus.
void check_least_impedance(ElementCheck& check, Ref const& bus, double positive_ohm, double zero_ohm);

} // namespace gridspace::sim::elements

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/network/network.hpp"

namespace gridspace::sim {

/// A power and its slope over voltage.
struct VoltagePower {
    double p{0}, q{0};
    double dp_dv{0}, dq_dv{0};
};

/// Multipliers of a load's nominal powers at a voltage v (p.u.), for its model. Below `floor_pu` every load becomes a
/// constant impedance that meets the model at the floor: constant power has no solution near a fault.
[[nodiscard]] VoltagePower load_factor(Load const& load, double v, double floor_pu = 0.7);

} // namespace gridspace::sim

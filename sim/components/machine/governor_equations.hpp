// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/machine/machine_data.hpp"
#include "sim/components/machine/rotor_state.hpp"

/// Speed governors and prime movers. Only for a machine with a `governor`.
namespace gridspace::sim::machines {

/// Of the turbine or engine.
[[nodiscard]] double governed_power(MachineData const& data, State const& x);

/// x' of the states of governor and prime mover; `electric_power` is what the machine gives at its terminals.
void governor_derivative(MachineData const& data, Setpoints const& set, State const& x, double electric_power,
                         State& dx);

/// limit() of rotor_equations.hpp, for the same states.
void limit_governor(MachineData const& data, Setpoints const& set, State& x);

/// The steady state that gives `power`, while the machine gives `electric_power`: its states, p_ref and mode.
void start_governor(MachineData const& data, double power, double electric_power, Setpoints& set, State& x);

} // namespace gridspace::sim::machines

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/machine/machine_data.hpp"
#include "sim/components/machine/rotor_state.hpp"

/// Voltage regulators, exciters and stabilizers (IEEE 421.5). Only for a machine with an `avr`.
namespace gridspace::sim::machines {

/// Where the regulator of a static exciter drives the field voltage, but for its limits and its time constant.
[[nodiscard]] double field_target(MachineData const& data, Setpoints const& set, State const& x);

/// What the field gets at a field current and terminal voltage |v|.
[[nodiscard]] double exciter_output(MachineData const& data, State const& x, double field_current, double v);

/// x' of the states of regulator, exciter and stabilizer.
void exciter_derivative(MachineData const& data, Setpoints const& set, State const& x, double field_current, double v,
                        State& dx);

/// limit() of rotor_equations.hpp, for the same states.
void limit_exciter(MachineData const& data, Setpoints const& set, double v, State& x);

/// The steady state that gives the field voltage `efd` at the measured voltage x[kVmeas]: its states and v_ref.
void start_exciter(MachineData const& data, double efd, Setpoints& set, State& x);

} // namespace gridspace::sim::machines

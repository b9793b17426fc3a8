// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/machine/regulators.hpp"
#include "sim/components/machine/rotor_state.hpp"

/// Woodward's governor of a diesel engine, DEGOV and DEGOV1 of PSS/E: electric control box, actuator, and an engine
/// whose torque follows its throttle after a dead time. The integral of the actuator holds the speed alone; a droop
/// makes DEGOV1 of it. Only for a governor with a `degov`.
namespace gridspace::sim::machines {

/// Torque times speed.
[[nodiscard]] double degov_power(Degov const& engine, State const& x);

/// x' of its states.
void degov_derivative(Governor const& governor, Setpoints const& set, State const& x, double electric_power, State& dx);

/// The steady state with `power`: states, p_ref, and the mode, droop where it has one.
void start_degov(Governor const& governor, double power, double electric_power, Setpoints& set, State& x);

} // namespace gridspace::sim::machines

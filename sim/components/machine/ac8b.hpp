// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/machine/machine_data.hpp"
#include "sim/components/machine/rotor_state.hpp"

/// AC8B of IEEE 421.5-2005, figure 6-8: PID control, an amplifier, an alternator and its diodes. Only for a machine
/// whose `avr` is one.
namespace gridspace::sim::machines {

/// What diodes give of an alternator's voltage `ve` when the current that they carry takes `drop` (KC IFD): VE FEX of
/// the three modes of IEEE 421.5-2005, annex D.
[[nodiscard]] double rectified(double ve, double drop);

/// x' of regulator and alternator for what the control has to correct, and a field current.
void ac8b_derivative(MachineData const& data, double error, double field_current, State const& x, State& dx);

/// Output of the amplifier when it has no time constant.
[[nodiscard]] double ac8b_regulator(MachineData const& data, double error, State const& x);

/// The steady state that gives the field voltage `efd`. Returns what the control then has to correct: 0 with an
/// integral.
[[nodiscard]] double start_ac8b(MachineData const& data, double efd, State& x);

} // namespace gridspace::sim::machines

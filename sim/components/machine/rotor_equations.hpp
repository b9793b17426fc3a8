// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/machine/machine_data.hpp"
#include "sim/components/machine/rotor_state.hpp"

#include <complex>

/// The rotor of a synchronous machine with its regulators: one field winding and one damper per axis. Both engines use
/// these equations; they differ in how they treat the stator. p.u. on the machine's rating, generator convention, speed
/// as deviation from nominal, d-axis behind the q-axis by 90 degrees. [Sauer and Pai, Power System Dynamics and
/// Stability, 1998, section 3.3; Kundur 1994, section 5.4]
namespace gridspace::sim::machines {

struct Flux {
    double d{0}, q{0};
};

/// Flux behind the reactance x2(): psi = flux - x2() i. `iq` and `id` matter only when the axes differ.
[[nodiscard]] Flux subtransient_flux(MachineData const& data, State const& x, double id, double iq);

/// Of the turbine or engine; without a governor what the machine began with.
[[nodiscard]] double mechanical_power(MachineData const& data, State const& x);

/// Field voltage for a stator current and terminal voltage |v|: what the exciter can give of what its regulator asks.
[[nodiscard]] double field_voltage(MachineData const& data, State const& x, double id, double v);

/// Air-gap torque for stator currents.
[[nodiscard]] double torque(MachineData const& data, State const& x, double id, double iq);

/// x' for stator currents and terminal voltage |v|, of the first data.states. Limited states do not move outwards.
void derivative(MachineData const& data, Setpoints const& set, State const& x, double id, double iq, double v,
                State& dx);

/// Puts limited states back into their limits, and algebraic regulators (time constant 0) where they belong.
void limit(MachineData const& data, Setpoints const& set, double v, State& x);

struct Start {
    State x;
    Setpoints set;
};
/// The steady state with terminal voltage v and current i (out of the machine). `electrical_speed` is the speed at
/// which stator flux turns, p.u.: 1, or what a discrete-time stator makes of it.
[[nodiscard]] Start steady_state(MachineData const& data, std::complex<double> v, std::complex<double> i,
                                 double electrical_speed = 1);

} // namespace gridspace::sim::machines

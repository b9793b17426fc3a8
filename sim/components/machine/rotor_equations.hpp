// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/machine/machine_data.hpp"

#include <array>
#include <complex>
#include <cstddef>
#include <string_view>

/// The rotor of a synchronous machine with its regulators: one field winding and one damper per axis. Both engines use
/// these equations; they differ in how they treat the stator. p.u. on the machine's rating, generator convention, speed
/// as deviation from nominal, d-axis behind the q-axis by 90 degrees. [Sauer and Pai, Power System Dynamics and
/// Stability, 1998, section 3.3; Kundur 1994, section 5.4]
namespace gridspace::sim::machines {

enum StateIndex : std::size_t {
    kEq1,      ///< voltage behind the transient reactance (field flux)
    kPsi1d,    ///< flux of the d damper
    kPsi2q,    ///< flux of the q damper
    kSpeed,    ///< deviation from nominal
    kAngle,    ///< of the q-axis, rad, in a frame that turns at nominal frequency
    kEfd,      ///< field voltage
    kVmeas,    ///< measured terminal voltage
    kGate,     ///< governor servo
    kPower,    ///< turbine power
    kIntegral, ///< of the speed deviation
    kExhaust,  ///< temperature of the exhaust as power; with a load limit
    kLead, ///< of the lead-lag before the regulator's gain: this and what follows with more than the simplest exciter
    kRate, ///< of the rate feedback
    kWashout, ///< of the stabilizer
    kFirst,   ///< of its first lead-lag
    kSecond,  ///< of its second lead-lag
    kStates
};
using State = std::array<double, kStates>;

/// What a governor does about the speed. droop: its integral stays where it is; fixed_power: nothing.
enum class GovernorMode { isochronous, droop, fixed_power };
[[nodiscard]] GovernorMode governor_mode(std::string_view word);

/// What the regulators hold.
struct Setpoints {
    double v_ref{1}, p_ref{0};
    double w_ref{0}; ///< of the speed, as deviation from nominal
    GovernorMode governor{GovernorMode::isochronous};
    double efd{0}; ///< without a regulator
};

struct Flux {
    double d{0}, q{0};
};

/// Flux behind the reactance x2(): psi = flux - x2() i. `iq` and `id` matter only when the axes differ.
[[nodiscard]] Flux subtransient_flux(MachineData const& data, State const& x, double id, double iq);

/// How many of the states move.
[[nodiscard]] std::size_t moving_states(MachineData const& data);

/// Of the turbine; without a governor what the machine began with.
[[nodiscard]] double mechanical_power(MachineData const& data, State const& x);

/// Where the regulator drives the field voltage, but for its limits and its time constant.
[[nodiscard]] double field_target(MachineData const& data, Setpoints const& set, State const& x);

/// Field voltage for a stator current and terminal voltage |v|: what the exciter can give of what its regulator asks.
[[nodiscard]] double field_voltage(MachineData const& data, State const& x, double id, double v);

/// Air-gap torque for stator currents.
[[nodiscard]] double torque(MachineData const& data, State const& x, double id, double iq);

/// x' for stator currents and terminal voltage |v|. Limited states do not move outwards.
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

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/machine/dead_time.hpp"

#include <array>
#include <cstddef>
#include <string_view>

namespace gridspace::sim::machines {

enum StateIndex : std::size_t {
    kEq1,      ///< voltage behind the transient reactance (field flux)
    kPsi1d,    ///< flux of the d damper
    kPsi2q,    ///< flux of the q damper
    kSpeed,    ///< deviation from nominal
    kAngle,    ///< of the q-axis, rad, in a frame that turns at nominal frequency
    kEfd,      ///< field voltage; of AC8B the alternator's before its rectifier (VE)
    kVmeas,    ///< measured terminal voltage
    kGate,     ///< governor servo; of DEGOV the throttle
    kPower,    ///< turbine power; of DEGOV the measured electric power
    kIntegral, ///< of the speed deviation
    kExhaust,  ///< temperature of the exhaust as power; with a load limit
    kLead, ///< of the lead-lag before the regulator's gain: this and what follows with more than the simplest exciter
    kRate, ///< of the rate feedback
    kWashout,   ///< of the stabilizer
    kFirst,     ///< of its first lead-lag
    kSecond,    ///< of its second lead-lag
    kRegulator, ///< AC8B: output of the regulator (VR)
    kBox,       ///< DEGOV, and what follows: electric control box
    kBoxRate,   ///< its motion
    kActuator,  ///< lag t5 of the actuator
    kActuator2, ///< lag t6 of the actuator
    kDeadTime,  ///< first of the states of the dead time
    kStates = kDeadTime + DeadTime::kOrder,
    kPidIntegral = kLead, ///< AC8B: integral part
    kPidLag = kRate       ///< AC8B: lag of the derivative part
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

} // namespace gridspace::sim::machines

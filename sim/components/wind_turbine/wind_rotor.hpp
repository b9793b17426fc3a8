// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <array>
#include <cstddef>
#include <optional>

/// Rotor, shaft, blade pitch and power order of a wind turbine with a converter: both engines use these equations. p.u.
/// of rated power and of the rotor's speed at rated wind. [WECC Wind Plant Dynamic Modeling Guidelines, 2014: WTGT_A,
/// WTGPT_A, WTGTRQ_A; power coefficient: Heier, Grid Integration of Wind Energy Conversion Systems, 1998, chapter 2]
namespace gridspace::sim::wind {

/// Two masses: 2 H w' = torques, a shaft between them that rings at a frequency of its own.
struct Shaft {
    double turbine_share{0.9}, frequency_hz{1.8}, damping_pu{1.5};
};

struct PitchControl {
    double kp{150}, ki{25}; ///< degrees per p.u. of speed, and per second
    double t_s{0.3}, rate_deg_s{10}, max_deg{45};
};

struct RotorData {
    double rated_wind_m_s{12}, cut_out_m_s{25}, restart_m_s{22};
    double speed_min_pu{0.4}; ///< below it gives no power
    double inertia_h_s{4};    ///< of all that turns
    double power_lag_s{0.05}; ///< of the converter's power behind its order
    PitchControl pitch;
    std::optional<Shaft> shaft;
    /// cp = c1 (c2 y - c3 b - c4) exp(-c5 y) + c6 l with 1/(l + 0.08 b) - 0.035/(b^3 + 1) = y
    std::array<double, 6> cp{0.5176, 116, 0.4, 5, 21, 0.0068};

    double best_ratio{0}, best_cp{0}; ///< tip speed ratio with the largest cp at pitch 0; complete() finds it
    /// Computes what follows from the rest; false: cp has no maximum above 0.
    bool complete();
};

/// The keys of the network file.
void rotor_fields(config::Fields& f, RotorData& out);

enum StateIndex : std::size_t {
    kTurbine,  ///< speed of the blades
    kMachine,  ///< speed of the generator; without a shaft that of the blades
    kTwist,    ///< torque of the shaft
    kPitch,    ///< degrees
    kIntegral, ///< of the pitch control, degrees
    kPower,    ///< that the converter takes from the generator
    kStates
};
using State = std::array<double, kStates>;

/// Power coefficient at a tip speed ratio and a pitch (degrees); not below 0.
[[nodiscard]] double power_coefficient(RotorData const& data, double ratio, double pitch_deg);

/// Power that the wind gives the blades at a speed.
[[nodiscard]] double blade_power(RotorData const& data, double wind_m_s, double speed, double pitch_deg);

/// Power that the converter is asked for at a speed: the cube, which is the best tip speed ratio, down to nothing at
/// speed_min_pu and up to `limit`.
[[nodiscard]] double power_order(RotorData const& data, double speed, double limit);

/// What it does is decided outside: whether it runs, and the power that is taken from its generator.
struct Operation {
    double wind_m_s{0};
    double limit_pu{1};
    bool runs{true}; ///< otherwise its blades turn out of the wind and a brake holds them
    double taken_pu{0};
};
void derivative(RotorData const& data, Operation const& now, State const& x, State& dx);

/// The steady state at this wind; nothing when even the largest pitch leaves more than rated power.
[[nodiscard]] std::optional<State> steady_state(RotorData const& data, double wind_m_s, bool runs);

/// Whether it runs from now on at this wind: stops above cut-out, starts again below the other bound.
[[nodiscard]] inline bool goes_on(RotorData const& data, double wind_m_s, bool runs) {
    return wind_m_s <= (runs ? data.cut_out_m_s : data.restart_m_s);
}

} // namespace gridspace::sim::wind

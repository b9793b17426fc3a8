// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace gridspace::relay {

/// Dependent-time characteristics of IEC 60255-151:2009, table A.1 (A to F). D, E and F are those of IEEE C37.112-1996,
/// table 1.
enum class Curve : std::uint8_t {
    definite_time,
    iec_normal_inverse,      ///< A
    iec_very_inverse,        ///< B
    iec_extremely_inverse,   ///< C
    ieee_moderately_inverse, ///< D
    ieee_very_inverse,       ///< E
    ieee_extremely_inverse,  ///< F
};

/// The ratio of current to setting above which the time no longer falls: G_D = 20 G_S (IEC 60255-151, 5.2.2).
inline constexpr double kCurveEnds = 20;

/// Operate time in seconds at `ratio` times the setting, and a time multiplier of 1:
/// t = k / (ratio^alpha - 1) + c (IEC 60255-151, equation 1). Infinite at 1 and below. Not of definite_time.
[[nodiscard]] double operate_time_s(Curve curve, double ratio);

/// Whether the standard gives a dependent reset time: D, E and F.
[[nodiscard]] bool has_dependent_reset(Curve curve);
/// Time in seconds from just operating to fully reset at `ratio` below 1, and a time multiplier of 1:
/// t = t_r / (1 - ratio^alpha) (IEC 60255-151, equation 3). Only with a dependent reset.
[[nodiscard]] double reset_time_s(Curve curve, double ratio);

} // namespace gridspace::relay

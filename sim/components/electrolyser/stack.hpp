// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Cells of an alkaline electrolyser in series, at a temperature that is kept. [Ulleberg, Modeling of advanced alkaline
/// electrolyzers: a system simulation approach, Int. J. Hydrogen Energy 28, 2003]
///
///     U = U_rev + (r1 + r2 T) I / A + s log10((t1 + t2 / T + t3 / T^2) I / A + 1)          T in degrees C
///     eta_F = (I / A)^2 / (f1 + (I / A)^2) f2                                             I / A in mA / cm2
///     hydrogen = eta_F cells I / (2 F)                                                    mol / s, F: Faraday's
///     constant
namespace gridspace::sim {

/// The coefficients of one cell of the PHOEBUS plant. t1 is reprinted as -1.002 (no logarithm at 80 degrees) and 1.002
/// too (32 kW at the plant's 750 A); -0.1002 gives 27.7 kW there, where its nameplate says 26.
struct CellCurve {
    double r1{8.05e-5};       ///< ohm m2
    double r2{-2.5e-7};       ///< ohm m2 / degree
    double s{0.185};          ///< V
    double t1{-0.1002};       ///< m2 / A
    double t2{8.424};         ///< m2 degree / A
    double t3{247.3};         ///< m2 degree2 / A
    double f1{250}, f2{0.96}; ///< mA2 / cm4; the highest current efficiency
};

struct Stack {
    CellCurve curve;
    double cells{21};
    double area_m2{0.25}, temperature_c{80};

    /// At atmospheric pressure, V. [LeRoy, Bowen and LeRoy, The thermodynamics of aqueous water electrolysis,
    /// J. Electrochem. Soc. 127(9), 1980]
    [[nodiscard]] double reversible_v() const;
    /// r1 + r2 T, and the factor of the current density in the logarithm: not negative of a curve that makes sense.
    [[nodiscard]] double resistance_ohm_m2() const;
    [[nodiscard]] double activation_m2_per_a() const;
    /// Of one cell at a current.
    [[nodiscard]] double cell_v(double current_a) const;
    /// The current at which all cells take this power (>= 0).
    [[nodiscard]] double current_a(double power_w) const;
    /// Hydrogen per second, g.
    [[nodiscard]] double hydrogen_g_per_s(double current_a) const;
};

} // namespace gridspace::sim

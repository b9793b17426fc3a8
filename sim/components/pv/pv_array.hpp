// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

namespace gridspace::sim {

/// Modules of cells by the five parameters of their single-diode model at 1000 W/m2 and 25 degrees, as module databases
/// list them. [De Soto, Klein and Beckman, Solar Energy 80(1), 2006]
struct PvArray {
    double series{1}, strings{1}; ///< modules in a string, strings in parallel
    double il_a{0}, i0_a{0};      ///< light current, diode saturation current
    double rs_ohm{0}, rsh_ohm{0};
    double a_v{0};        ///< modified ideality factor: ideality, cells in series and thermal voltage
    double alpha_a_k{0};  ///< temperature coefficient of the short-circuit current
    double noct_c{45};    ///< nominal operating cell temperature
    double efficiency{1}; ///< of the inverter
    double mppt_s{0};     ///< time constant of the tracker; 0: always at the maximum

    void fields(config::Fields& f);

    /// A module at an irradiance (p.u. of 1000 W/m2) and an ambient temperature.
    struct Module {
        double il, i0, rsh, rs, a;
        /// Current and power at a voltage across its diode, which is the terminal voltage and rs times the current.
        [[nodiscard]] double current_a(double diode_v) const;
        [[nodiscard]] double voltage_v(double diode_v) const { return diode_v - rs * current_a(diode_v); }
        [[nodiscard]] double power_w(double diode_v) const { return voltage_v(diode_v) * current_a(diode_v); }
        [[nodiscard]] double slope_of_power(double diode_v) const; ///< W / V
        [[nodiscard]] double bend_of_power(double diode_v) const;  ///< W / V^2
        /// Diode voltages at the maximum of power, and above it where the power is `w`.
        [[nodiscard]] double best() const;
        [[nodiscard]] double above_best(double w) const;
    };
    [[nodiscard]] Module module_at(double sun, double ambient_c) const;
    [[nodiscard]] double cell_c(double sun, double ambient_c) const { return ambient_c + sun * (noct_c - 20) / 0.8; }
    /// Power into the network of all modules of which each gives `w`.
    [[nodiscard]] double kw(double w) const { return series * strings * w * efficiency / 1e3; }
    [[nodiscard]] double module_w(double kw) const { return kw * 1e3 / (series * strings * efficiency); }
};

} // namespace gridspace::sim

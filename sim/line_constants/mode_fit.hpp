// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/circuit/circuit.hpp"

#include <complex>
#include <functional>

namespace gridspace::sim {

/// One mode of a line at an angular frequency: series impedance, and shunt capacitance, which does not depend on it.
struct ModePerMetre {
    std::function<std::complex<double>(double omega)> z_ohm_per_m;
    double c_f_per_m{0};

    /// A line that is cut off loses its charge with this time constant: without any leakage the characteristic
    /// impedance of direct current would be infinite.
    static constexpr double kLeakageS = 100;
    [[nodiscard]] std::complex<double> y_s_per_m(double omega) const {
        return c_f_per_m * std::complex<double>{1 / kLeakageS, omega};
    }
    [[nodiscard]] std::complex<double> surge_ohm(double omega) const {
        return std::sqrt(z_ohm_per_m(omega) / y_s_per_m(omega));
    }
    [[nodiscard]] std::complex<double> per_m(double omega) const {
        return std::sqrt(z_ohm_per_m(omega) * y_s_per_m(omega));
    }
};

/// J. Marti's model of a mode [IEEE Trans. PAS-101(1), 1982]: characteristic impedance and propagation as rational
/// functions, 1 mHz to 300 kHz, which are exact at the nominal frequency and for direct current. Fails when they are
/// not within 1 % (root mean square): the data are then no line's.
[[nodiscard]] Result<emt::MartiLine::Mode> fit_mode(ModePerMetre const& mode, double length_m, double nominal_omega);

} // namespace gridspace::sim

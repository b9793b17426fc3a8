// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>
#include <string>
#include <utility>
#include <vector>

namespace gridspace::opendss {

using Complex = std::complex<double>;

/// How the power of a phase depends on its voltage [OpenDSS manual, "Load": model 1 to 8].
struct LoadLaw {
    int model{1};
    Complex power_va;      ///< of a phase, at nominal voltage
    double nominal_v{0};   ///< across the phase
    double least_pu{0.95}; ///< below: an impedance that carries what it draws at `least_pu`, going over to
    double most_pu{1.05};  ///< above: one that carries it at `most_pu`
    double low_pu{0.5};    ///< below: the impedance of the nominal power. 0: the former down to 0 V (generators)
    double exponent_p{1}, exponent_q{2}; ///< model 4
    double fixed_var{0};                 ///< models 6 and 7: of a phase, whatever shapes and multipliers say
    std::array<double, 7> shares{};      ///< model 8: Z, I, P of active power, the same of reactive, dropout p.u.

    [[nodiscard]] Complex admittance() const; ///< of the nominal power, S
    /// The current into a phase at the voltage across it, A.
    [[nodiscard]] Complex current(Complex v) const;

  private:
    [[nodiscard]] Complex within(Complex v, double pu) const;
    [[nodiscard]] Complex below(Complex v, double pu) const;
    [[nodiscard]] Complex above(Complex v) const;
    /// The admittance outside of the range, where that of a constant current is `current` and that of a constant power
    /// `power` times the nominal one.
    [[nodiscard]] Complex in_parts(double current, double power) const;
};

/// A load, or a generator (with negative power): phases that each follow the law between two nodes.
struct Consumer {
    std::string name; ///< "load.671"
    bool generates{false};
    std::vector<std::pair<int, int>> phases; ///< nodes; -1: earth
    LoadLaw law;
};

} // namespace gridspace::opendss

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <complex>
#include <string>
#include <vector>

namespace gridspace::sim {

/// The conductors of an overhead line over earth, as they hang on a tower.
struct Tower {
    enum class Belongs { a, b, c, earth };
    struct Wire {
        Belongs phase{Belongs::a};
        double x_m{0}, height_m{0}; ///< mean over the span
        double radius_m{0}, dc_ohm_per_km{0};
    };
    std::vector<Wire> wires; ///< empty: no tower was given
    double earth_ohm_m{100};

    void fields(config::Fields& f);
    [[nodiscard]] bool given() const { return !wires.empty(); }
    /// What makes it no tower: a phase without conductor, two in one place; empty when it is one.
    [[nodiscard]] std::string mistake() const;

    /// Positive and zero sequence of the transposed line, per metre: mean own and mutual values of the phases;
    /// conductors of one phase have one voltage, earth wires have none.
    struct Sequences {
        std::complex<double> z1_ohm, z0_ohm;
        double c1_f{0}, c0_f{0};
    };
    [[nodiscard]] Sequences per_metre(double omega) const;
};

} // namespace gridspace::sim

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "sim/components/line/sequences_per_metre.hpp"

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

    /// Of the transposed line: mean own and mutual values of the phases; conductors of one phase have one voltage,
    /// earth wires have none.
    [[nodiscard]] SequencesPerMetre per_metre(double omega) const;
};

} // namespace gridspace::sim

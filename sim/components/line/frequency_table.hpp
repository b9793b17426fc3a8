// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "sim/components/line/sequences_per_metre.hpp"

#include <string>
#include <vector>

namespace gridspace::sim {

/// Resistance and inductance per km over frequency, as a program for line or cable constants prints them.
struct FrequencyTable {
    std::vector<double> hz; ///< rising; empty: no table was given
    std::vector<double> r_ohm_per_km, l_mh_per_km, r0_ohm_per_km, l0_mh_per_km;

    void fields(config::Fields& f);
    [[nodiscard]] bool given() const { return !hz.empty(); }
    /// What makes it no table: too few values, frequencies that do not rise; empty when it is one.
    [[nodiscard]] std::string mistake() const;

    /// Impedances only. Between two frequencies logarithms of r, and l, are straight over the logarithm of frequency.
    /// Below the first both stay; beyond the last r rises with the root of frequency, and l falls as skin effect then
    /// has it.
    [[nodiscard]] SequencesPerMetre per_metre(double omega) const;
};

} // namespace gridspace::sim

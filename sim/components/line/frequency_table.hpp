// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "sim/components/line/sequences_per_metre.hpp"
#include "sim/line_constants/series_fit.hpp"

#include <string>
#include <vector>

namespace gridspace::sim {

/// Resistance and inductance per km over frequency, as a program for line or cable constants prints them.
struct FrequencyTable {
    std::vector<double> hz; ///< rising; empty: no table was given
    std::vector<double> r_ohm_per_km, l_mh_per_km, r0_ohm_per_km, l0_mh_per_km;

    void fields(config::Fields& f);
    [[nodiscard]] bool given() const { return !hz.empty(); }
    /// What makes it no table: too few values, frequencies that do not rise, r and l that no line has; empty when it is
    /// one.
    [[nodiscard]] std::string mistake() const;

    /// Impedances only: those of the passive network of resistances and inductances that is nearest to the table.
    [[nodiscard]] SequencesPerMetre per_metre(double omega) const;

  private:
    [[nodiscard]] std::string shape_mistake() const;
    SeriesImpedance one_, zero_; ///< ohm and H per m
    double error_{0};
};

} // namespace gridspace::sim

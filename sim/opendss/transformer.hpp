// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace gridspace::opendss {

struct WindingData {
    bool delta{false};
    double kv{12.47};                           ///< line to line for 2 and 3 phases in star, else across the winding
    double kva{1000};                           ///< of all phases
    double tap{1};                              ///< p.u.
    double r_pu{0.002};                         ///< of the winding's rating, as all per-unit values here
    double neutral_r_ohm{-1}, neutral_x_ohm{0}; ///< between neutral and earth; negative: none but what the bus says
    double least_tap{0.9}, most_tap{1.1};
    int taps{32};

    [[nodiscard]] double step() const { return taps > 0 ? (most_tap - least_tap) / taps : 0; }
};

/// A transformer of 1 to 3 phases and 2 or more windings, or a bank's part [OpenDSS, "Modeling Multi-Winding
/// Transformers"]: short-circuit impedances between the windings of a phase, brought to the terminals.
struct Transformer {
    int phases{3};
    std::vector<WindingData> windings{2};
    std::vector<double> x_pu{0.07, 0.35, 0.30}; ///< 1-2, 1-3, …, 2-3, …, on the rating of winding 1
    double no_load_pu{0}, magnetising_pu{0};    ///< at the second winding
    double float_share{1e-6};                   ///< of nominal power, to earth from each end of a winding, reactive
    bool high_leads{false};                     ///< star-delta by the Euro standard: the high voltage leads

    [[nodiscard]] int conductors() const { return phases + 1; }
    /// V across a winding at its nominal voltage.
    [[nodiscard]] double winding_v(std::size_t winding) const;
    /// The conductors (of all terminals) between which phase `phase` of a winding lies.
    [[nodiscard]] std::pair<int, int> ends(std::size_t winding, int phase) const;
    /// S, of all conductors of all windings. Fails (empty) when the impedances have no inverse.
    [[nodiscard]] Eigen::MatrixXcd admittance() const;
};

} // namespace gridspace::opendss

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace gridspace::sim {

/// A bare conductor over earth.
struct Conductor {
    double x_m{0}, height_m{0};
    double dc_ohm_per_m{0}, ac_ohm_per_m{0};
    double gmr_m{0}; ///< 0: a solid round wire, whose inner inductance falls with frequency as its resistance rises
    double radius_m{0};
};

enum class EarthModel {
    deri, ///< complex depth, skin effect of the conductor [Deri et al., IEEE Trans. Power Apparatus Syst. 100(8), 1981]
    carson, ///< the first terms of Carson's series, resistance as given
};

struct LineConstants {
    Eigen::MatrixXcd z_ohm_per_m;
    Eigen::MatrixXd c_f_per_m;
};

/// Constants of parallel conductors over earth of `rho_ohm_m`; those beyond `phases` are earthed neutrals and reduced
/// (Kron). Conductors above each other or on the ground make no finite constants.
[[nodiscard]] LineConstants line_constants(std::vector<Conductor> const& conductors, int phases, double frequency_hz,
                                           double rho_ohm_m, EarthModel model);

} // namespace gridspace::sim

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>

namespace gridspace::sim {

/// Positive and zero sequence of a line at one frequency.
struct SequencesPerMetre {
    std::complex<double> z1_ohm, z0_ohm;
    double c1_f{0}, c0_f{0};
};

} // namespace gridspace::sim

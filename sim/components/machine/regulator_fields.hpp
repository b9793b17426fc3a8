// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/number_specs.hpp"
#include "sim/components/machine/regulators.hpp"

namespace gridspace::sim {

/// Keys of an `avr:`.
void read_regulator(config::Fields& f, Avr& r);

/// Keys of a `governor:`.
void read_governor(config::Fields& f, Governor& g);

} // namespace gridspace::sim

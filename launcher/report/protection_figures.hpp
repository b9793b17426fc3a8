// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/report/figure.hpp"
#include "launcher/report/wire_timing.hpp"
#include "launcher/scenario/published.hpp"

#include <vector>

namespace gridspace::launcher {

/// Frequency of machines, their mean and a phase-locked loop, over the run and around a relay's trip; currents of both
/// ends around the trip. For runs with waveforms.
[[nodiscard]] std::vector<Figure> protection_figures(Results const& results, config::Node const& scenario,
                                                     WireTiming const& timing, Published const& published);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/report/figures.hpp"

namespace gridspace::launcher {

/// The time-current curves of all overcurrent functions that publish their currents (`functions: NAME: publish_values`)
/// on one sheet, as they are graded, with the points at which they operated or let go.
void time_current_curves(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/report/figures.hpp"

namespace gridspace::launcher {

/// Of each relay with zones of distance protection that publish what they measure (`functions: NAME: publish_values`)
/// the plane of resistance and reactance: the zones, and the path of the loops that come near them.
void impedance_planes(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/report/figures.hpp"

#include <vector>

namespace gridspace::launcher {

/// Differential over restraint current of relays that publish them (`element: publish_values`), with the characteristic
/// of their element: a figure for each. Where a path begins is a dot, where it picks up and trips is named with its
/// time.
void restraint_planes(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out);

} // namespace gridspace::launcher

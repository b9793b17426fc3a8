// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/report/figures.hpp"

#include <vector>

namespace gridspace::launcher {

/// The interval of each GOOSE message to the one before, around the first new state: a figure for each stream.
void message_intervals(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out);

/// Samples per second in windows of a tenth of a second. Nothing in lockstep.
void sample_rate(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out);

/// How often which interval between two frames of sampled values came. Nothing in lockstep.
void frame_intervals(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/report/figures.hpp"

#include <vector>

namespace gridspace::launcher {

/// The clearest fake on each watched stream, with forecast and accepted waveform.
void forged_samples(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out);

/// The trip of each relay on its first fault, with its detector and without.
void trip_comparisons(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out);

/// Detected fakes against false positives as the threshold is varied, per watched stream that was attacked.
void roc_curves(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/report/figures.hpp"
#include "launcher/report/intrusion_score.hpp"

#include <string>
#include <vector>

namespace gridspace::launcher {

/// The clearest fake of each watched stream with forecast and accepted waveform, and trips with and without the
/// detector.
[[nodiscard]] std::vector<Figure> intrusion_figures(IntrusionScore const& score);

/// Confusion matrices, attacks, and what the relays did.
[[nodiscard]] std::vector<ReportTable> intrusion_tables(IntrusionScore const& score);

/// A drawing that is not over time.
struct Drawing {
    std::string id, title, svg;
};
/// Detected fakes against false positives as the threshold is varied, per watched stream that was attacked.
[[nodiscard]] std::vector<Drawing> intrusion_drawings(IntrusionScore const& score);

/// The points of that: threshold as a multiple of the one that was used.
struct RocPoint {
    double threshold{0}, false_positive_percent{0}, detected_percent{0};
};
[[nodiscard]] std::vector<RocPoint> roc_of(IntrusionRecording const& recording, IntrusionRecording::Track const& track);

} // namespace gridspace::launcher

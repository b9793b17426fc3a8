// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/intrusion_recording.hpp"

#include <vector>

namespace gridspace::launcher {

/// Detected fakes against false positives at a threshold, as a multiple of the one that was used.
struct RocPoint {
    double threshold{0}, false_positive_percent{0}, detected_percent{0};
};
/// From 0.1 to 40 times the threshold; empty where nothing was forged or nothing genuine was judged.
[[nodiscard]] std::vector<RocPoint> roc_of(IntrusionRecording const& recording, IntrusionRecording::Track const& track);

} // namespace gridspace::launcher

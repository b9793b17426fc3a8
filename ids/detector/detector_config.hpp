// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "ids/detector/line_detector.hpp"

#include <filesystem>
#include <string>

namespace gridspace::ids {

/// The `ids:` of a relay.
struct DetectorConfig {
    Mode mode{Mode::supervise};
    std::filesystem::path model;
    ThresholdParams::Of of{ThresholdParams::Of::adaptive};
    double percent{2}, nominal_peak_a{0}, sigmas{6}, ceiling_percent{4.5};
    std::int64_t hold_off_samples{8};
    SupervisorParams::OnUnconfirmed on_unconfirmed{SupervisorParams::OnUnconfirmed::delay};
    double delay_ms{20}, kirchhoff_percent{3}, class_percent{11};
    enum class Guard { both, from, to } guard{Guard::both};
    std::string verdicts; ///< topic; empty: none
};
void describe(config::Fields& f, DetectorConfig& config);

/// The detector's parameters for streams of `rate_hz`. Lengths that are times (one cycle, the delay) become samples
/// here. An error when the threshold needs a nominal current and there is none, or the model was made for another rate.
[[nodiscard]] Result<DetectorParams> make_detector_params(DetectorConfig const& config, Model const& model,
                                                          double rate_hz, double frequency_hz);

} // namespace gridspace::ids

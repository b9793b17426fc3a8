// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/detector/detector_config.hpp"
#include "ids/forecaster/model.hpp"
#include "launcher/ids/scan/frequency_meter.hpp"

#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace gridspace::scan {

/// The forecaster of a scan, and what it needs to know of the currents.
struct ForecastSettings {
    std::optional<ids::Model> model; ///< nothing: only the rules
    double nominal_peak_a{0};        ///< 0: the largest of the first two cycles
    bool into_line{false};           ///< both current transformers count into the line
};

/// What matters to a forecaster is how many samples a cycle has: 80 at 4000 Hz and 50 Hz are those at 4800 Hz and 60
/// Hz.
[[nodiscard]] inline ids::Model at_rate(ids::Model model, double rate_hz) {
    model.frequency_hz *= rate_hz / model.rate_hz;
    model.rate_hz = rate_hz;
    return model;
}

[[nodiscard]] inline Result<ids::DetectorParams> detector_params(ids::Model const& fitted, ids::Mode mode,
                                                                 double nominal_peak_a) {
    ids::DetectorConfig config;
    config.mode = mode;
    config.nominal_peak_a = nominal_peak_a;
    return ids::make_detector_params(config, fitted, fitted.rate_hz, fitted.frequency_hz);
}

/// Why the verdicts of a forecaster for `wanted` samples a cycle say nothing about such currents; empty when they do.
/// Cycles that are all kinds of length are no reason: that is what forgeries make of them.
[[nodiscard]] inline std::string misfit(double wanted, std::optional<Cycles> const& seen) {
    constexpr double kNear = 0.025; // the shipped models have seen 59.5 to 60.5 Hz
    return !seen ? "no alternating current"
           : !seen->steady || std::fabs(seen->median - wanted) <= kNear * wanted
               ? ""
               : fmt::format("{:.1f} samples a cycle; the model is for {:g}", seen->median, wanted);
}

} // namespace gridspace::scan

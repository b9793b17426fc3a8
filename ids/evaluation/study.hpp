// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "ids/data/waveform.hpp"
#include "ids/detector/stream_guard.hpp"
#include "ids/scoring/interval.hpp"
#include "ids/training/train.hpp"

#include <functional>
#include <span>
#include <vector>

namespace gridspace::ids {

/// One shape of the forecaster: what it costs and what it gives. The published choice is 20 inputs and 10 neurons.
struct ShapeResult {
    int window{0}, hidden{0}; ///< hidden 0: linear
    int parameters{0};
    double rms_percent{0}; ///< error before events, of the nominal peak
    Share false_positive;  ///< before events, at 2 % of the larger peak
    double nanoseconds{0}; ///< a phase-sample on this machine
};
struct ShapeStudy {
    std::vector<int> windows{5, 10, 20, 40}, hidden{0, 5, 10, 20};
    std::size_t training_windows{8000};
    int epochs{20}, threads{2};
    double nominal_peak_a{10};
};
/// Where a study stands: shapes are trained one after the other, `share` of all their work is done (0 to 1).
struct StudyProgress {
    std::size_t shape{0}, of{0}; ///< from 1
    int window{0}, hidden{0}, epoch{0}, epochs{0};
    double share{0};
};
/// Trains each shape on `training` and judges it on `unseen`. `progress` after each epoch and each shape.
[[nodiscard]] Result<std::vector<ShapeResult>> study_shapes(ShapeStudy const& study, Model const& like,
                                                            std::span<LineWaveform const> training,
                                                            std::span<LineWaveform const> unseen, std::uint64_t seed,
                                                            std::function<void(StudyProgress const&)> const& progress);

/// The published loop under `fakes` forged samples in a row: how long can it run on its own forecasts?
struct FakesResult {
    int fakes{0};
    std::uint64_t runs{0};
    Share detected; ///< forged samples flagged
    double error_median_percent{0},
        error_p95_percent{0}; ///< the largest distance of what it accepted from the truth, of nominal
    Share locked_out;         ///< runs in which more than half of the samples 0.1 s later are rejected
};
[[nodiscard]] std::vector<FakesResult> study_fakes(Model const& model, std::span<int const> counts,
                                                   std::span<LineWaveform const> quiet, double nominal_peak_a,
                                                   std::uint64_t seed, int threads);

} // namespace gridspace::ids

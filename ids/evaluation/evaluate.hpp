// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/data/waveform.hpp"
#include "ids/detector/stream_guard.hpp"
#include "ids/scoring/interval.hpp"

#include <array>
#include <span>
#include <string>
#include <vector>

namespace gridspace::ids {

/// The ways of setting the threshold, in the order of the tables.
inline constexpr std::array<ThresholdParams::Of, 5> kThresholds{
    ThresholdParams::Of::instantaneous, ThresholdParams::Of::nominal_peak, ThresholdParams::Of::running_peak,
    ThresholdParams::Of::larger_peak, ThresholdParams::Of::adaptive};
[[nodiscard]] char const* name_of(ThresholdParams::Of of);

/// One-step forecasts of recordings nobody tampered with, each from the received samples before it.
struct ForecastQuality {
    std::uint64_t samples{0};                               ///< phase-samples
    double rms_percent{0}, p999_percent{0}, max_percent{0}; ///< error, of the nominal peak, before events
    std::array<Share, 5> before{}, first_cycle{},
        later{}; ///< false positives per phase-sample, by threshold (kThresholds)
};

struct AttackDetection {
    std::string attack;
    std::uint64_t runs{0};
    Share seen;                      ///< runs with at least one flag on the attacked stream while it lasted
    double median_delay_samples{-1}; ///< of the runs that were seen; -1: none
    Share samples;                   ///< altered phase-samples that were flagged
    Share kirchhoff_seen;            ///< runs in which the two ends differed by more than 2 % of the larger peak
};

struct Evaluation {
    double nominal_peak_a{0};
    ForecastQuality quality;
    std::vector<std::pair<std::string, ForecastQuality>> by_situation;
    std::vector<AttackDetection> attacks;
};

struct EvaluationOptions {
    double percent{2};
    double nominal_peak_a{0}; ///< 0: the largest magnitude of the first two cycles of all recordings
    ThresholdParams::Of attack_threshold{ThresholdParams::Of::larger_peak};
    bool attacks{true};
    std::uint64_t seed{1};
    int threads{2};
};

/// Judges a model on recordings. Recordings without a `to` end count for the `from` end alone. Nothing here depends on
/// the number of threads.
[[nodiscard]] Evaluation evaluate(Model const& model, std::span<LineWaveform const> recordings,
                                  EvaluationOptions const& options);

/// Nanoseconds that a forecast of one phase takes on this machine: the median of nine batches.
template <class Real>
[[nodiscard]] double nanoseconds_per_sample(Model const& model);
extern template double nanoseconds_per_sample<double>(Model const&);
extern template double nanoseconds_per_sample<float>(Model const&);

} // namespace gridspace::ids

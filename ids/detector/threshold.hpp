// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/detector/history.hpp"

namespace gridspace::ids {

struct ThresholdParams {
    enum class Of {
        instantaneous, ///< the received sample itself: ill-posed near zero crossings, there for comparison
        nominal_peak,
        running_peak, ///< of the last cycle
        larger_peak,  ///< of the two
        adaptive,     ///< larger_peak, and never below `sigmas` of the forecast error seen so far
    };
    Of of{Of::adaptive};
    double percent{2};
    double nominal_peak_a{0}; ///< crest value of the nominal current
    int peak_samples{80};     ///< one cycle
    double sigmas{6};
    double ceiling_percent{4.5};
    int noise_samples{480}; ///< memory of the noise estimate
};

/// How far one phase may be from its forecast. Errors are relative to max(nominal, running peak).
///
/// Noise: s is the exponentially weighted mean of min(e, 3 s), between 0.05 % and 0.75 %; sigma = 1.25 s, the standard
/// deviation of a normal error with that mean magnitude. The clipping keeps events and attacks out of it. It starts at
/// the upper end: a detector that knows nothing about the noise yet must not cry wolf.
class Threshold {
  public:
    explicit Threshold(ThresholdParams const& params) : params_{params}, peak_{params.peak_samples} {}

    [[nodiscard]] double limit_a(double received_a) const;
    /// Takes the sample that was accepted, and its distance from the forecast (negative: there was no forecast).
    void update(double accepted_a, double error_a);
    void clear() { peak_.clear(); }

    [[nodiscard]] double base_a() const { return std::max(params_.nominal_peak_a, peak_.value()); }
    [[nodiscard]] double running_peak_a() const { return peak_.value(); }
    [[nodiscard]] double sigma_percent() const { return 125 * mean_error_; }
    [[nodiscard]] bool settled() const { return seen_ >= 4 * params_.noise_samples; } ///< the start is forgotten

  private:
    ThresholdParams params_;
    RunningPeak peak_;
    static constexpr double kLowest = 0.0005, kHighest = 0.0075;
    double mean_error_{kHighest};
    int seen_{0};
};

} // namespace gridspace::ids

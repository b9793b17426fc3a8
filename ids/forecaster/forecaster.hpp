// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/forecaster/model.hpp"

#include <cstddef>
#include <vector>

namespace gridspace::ids {

/// Runs a model. No allocation per forecast; the same bits on every machine. Real is double or float.
template <class Real>
class Forecaster {
  public:
    /// `model` must have passed check().
    explicit Forecaster(Model const& model);

    [[nodiscard]] int window() const { return window_; }
    [[nodiscard]] int channels() const { return channels_; }

    /// The next sample of each channel. `history`: channels() x window() samples, phase by phase, oldest first; A.
    void forecast(Real const* history, Real* next);

    /// The next sample of three phases, with the bits of forecast(). `history`: 3 x window() samples, phase by phase,
    /// oldest first; A. A linear model of one channel takes the phases side by side.
    void forecast_phases(Real const* history, Real* next);

  private:
    struct Dense {
        std::size_t inputs{0}, outputs{0};
        bool squash{false};
        std::vector<Real> columns; ///< inputs x outputs: the inner loop runs over neurons, so it vectorises as written
        std::vector<Real> bias;
    };
    /// Writes `count` samples at `to`, divided by the scale, which it gives.
    Real scaled(Real const* history, std::size_t count, Real* to) const;

    int window_, channels_;
    bool scale_by_peak_;
    Real scale_a_;
    std::vector<Dense> layers_;
    std::vector<Real> a_, b_;
};

extern template class Forecaster<double>;
extern template class Forecaster<float>;

} // namespace gridspace::ids

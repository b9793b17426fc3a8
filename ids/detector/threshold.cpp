// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/detector/threshold.hpp"

#include <cmath>

namespace gridspace::ids {

double Threshold::limit_a(double received_a) const {
    using Of = ThresholdParams::Of;
    double const share = params_.percent / 100;
    switch (params_.of) {
    case Of::instantaneous:
        return share * std::fabs(received_a);
    case Of::nominal_peak:
        return share * params_.nominal_peak_a;
    case Of::running_peak:
        return share * peak_.value();
    case Of::larger_peak:
        return share * base_a();
    case Of::adaptive:
        break;
    }
    double const noise = params_.sigmas * 1.25 * mean_error_;
    return std::min(std::max(share, noise), std::max(share, params_.ceiling_percent / 100)) * base_a();
}

void Threshold::update(double accepted_a, double error_a) {
    double const base = base_a();
    if (error_a >= 0 && base > 0) {
        double const e = std::min(error_a / base, 3 * mean_error_);
        seen_ += settled() ? 0 : 1;
        mean_error_ += (e - mean_error_) / params_.noise_samples;
        mean_error_ = std::min(std::max(mean_error_, kLowest), kHighest);
    }
    peak_.push(accepted_a);
}

} // namespace gridspace::ids

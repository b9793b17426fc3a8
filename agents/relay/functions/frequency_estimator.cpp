// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/frequency_estimator.hpp"

#include "common/elementary.hpp"

#include <algorithm>
#include <numbers>

namespace gridspace::relay {
namespace {

constexpr double kSteadyHz = 0.5;

std::size_t step(std::size_t& next, std::size_t size) {
    std::size_t const at = next;
    next = next + 1 == size ? 0 : next + 1;
    return at;
}

} // namespace

FrequencyEstimator::FrequencyEstimator(FrequencyParams const& params)
    : params_{params}, average_{params.average_cycles * params.samples_per_cycle},
      rate_span_{params.rocof_cycles * params.samples_per_cycle},
      turned_(static_cast<std::size_t>(params.samples_per_cycle)), raw_(static_cast<std::size_t>(average_)),
      means_(static_cast<std::size_t>(rate_span_)), hz_{params.nominal_hz} {}

void FrequencyEstimator::clear() {
    seen_ = measured_ = 0;
    hz_ = params_.nominal_hz;
    hz_per_s_ = 0;
}

void FrequencyEstimator::push(Complex positive) {
    if (!(magnitude(positive) > params_.minimum)) {
        clear();
        return;
    }
    Complex& oldest = turned_[step(turned_next_, turned_.size())];
    Complex const gained = positive * std::conj(oldest);
    oldest = positive;
    if (seen_ < params_.samples_per_cycle) {
        ++seen_;
        return;
    }
    double const turns = elementary::atan2(gained.imag(), gained.real()) / (2 * std::numbers::pi);
    raw_[step(raw_next_, raw_.size())] = params_.nominal_hz * (1 + turns);
    measured_ = std::min(measured_ + 1, average_ + rate_span_);
    if (measured_ < average_) {
        return;
    }
    double sum = 0, low = raw_[0], high = raw_[0];
    for (double const f : raw_) {
        sum += f;
        low = std::min(low, f);
        high = std::max(high, f);
    }
    hz_ = sum / average_;
    double& before = means_[step(means_next_, means_.size())];
    hz_per_s_ = has_rate() ? (hz_ - before) * params_.nominal_hz / params_.rocof_cycles : 0;
    before = hz_;
    steady_ = high - low <= kSteadyHz ? hz_ / params_.nominal_hz : steady_;
}

} // namespace gridspace::relay

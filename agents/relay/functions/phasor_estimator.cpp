// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/phasor_estimator.hpp"

#include "common/elementary.hpp"

#include <algorithm>
#include <cassert>
#include <numbers>

namespace gridspace::relay {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

Complex unit(double angle) {
    return {elementary::cos(angle), elementary::sin(angle)};
}

/// Mean of e^(j angle k), k = 0 to n - 1.
Complex mean_of_turns(double angle, int n) {
    double const half = elementary::sin(angle / 2);
    if (std::fabs(half) < 1e-12) {
        return {1, 0};
    }
    return unit(angle * (n - 1) / 2) * (elementary::sin(n * angle / 2) / (n * half));
}

} // namespace

PhasorEstimator::PhasorEstimator(PhasorParams const& params)
    : params_{params}, rows_(2 * static_cast<std::size_t>(params.samples_per_cycle)) {
    assert(params.samples_per_cycle >= 4 && params.offset_samples >= 0);
    for (int i = 0; i < params.samples_per_cycle; ++i) {
        double const angle = kTwoPi * i / params.samples_per_cycle;
        cos_.push_back(elementary::cos(angle));
        sin_.push_back(elementary::sin(angle));
    }
    double const tau = params.offset_samples;
    gain_ = 1 / magnitude(Complex{1 + tau, 0} - tau * unit(-kTwoPi / params.samples_per_cycle));
    set_frequency(1);
}

void PhasorEstimator::set_frequency(double relative) {
    relative_ = std::clamp(relative, 0.5, 1.5);
    int const n = params_.samples_per_cycle;
    double const nominal = kTwoPi / n, angle = nominal * relative_, tau = params_.offset_samples;
    own_ = mean_of_turns(angle - nominal, n);
    image_ = mean_of_turns(-(angle + nominal), n);
    double const determinant = std::norm(own_) - std::norm(image_);
    after_ = unit(angle * (n - 1) / 2) / (gain_ * (Complex{1 + tau, 0} - tau * unit(-angle)) * determinant);
}

void PhasorEstimator::push(Abc const& sample) {
    Abc row = sample;
    if (params_.offset_samples > 0) {
        for (std::size_t p = 0; p < 3; ++p) {
            row[p] = gain_ * ((1 + params_.offset_samples) * sample[p] - params_.offset_samples * last_[p]);
        }
        last_ = sample;
    }
    auto const at = static_cast<std::size_t>(next_);
    rows_[at] = rows_[at + static_cast<std::size_t>(params_.samples_per_cycle)] = row;
    next_ = next_ + 1 == params_.samples_per_cycle ? 0 : next_ + 1;
    filled_ = std::min(filled_ + 1, params_.samples_per_cycle + 1); // the first one has nothing before it to filter by
}

Phasors PhasorEstimator::phasors() const {
    assert(full());
    Abc const* const window = &rows_[static_cast<std::size_t>(next_)]; // oldest sample
    Abc re{}, im{};
    for (int i = 0; i < params_.samples_per_cycle; ++i) {
        double const c = cos_[static_cast<std::size_t>(i)], s = sin_[static_cast<std::size_t>(i)];
        for (std::size_t p = 0; p < 3; ++p) {
            re[p] += window[i][p] * c;
            im[p] -= window[i][p] * s;
        }
    }
    double const to_rms = std::numbers::sqrt2 / params_.samples_per_cycle;
    Phasors out;
    for (std::size_t p = 0; p < 3; ++p) {
        Complex const seen{re[p] * to_rms, im[p] * to_rms};
        out[p] = (std::conj(own_) * seen - image_ * std::conj(seen)) * after_;
    }
    return out;
}

} // namespace gridspace::relay

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/differential_element.hpp"

#include "common/elementary.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::relay {

Result<int> whole_samples(Rational rate_hz, Rational frequency_hz, Rational cycles) {
    if (rate_hz <= Rational{0} || frequency_hz <= Rational{0} || cycles <= Rational{0}) {
        return fail(ExitCode::usage, "sampling rate, frequency and window must be positive");
    }
    Rational const samples = rate_hz * cycles / frequency_hz;
    if (!samples.is_whole()) {
        return fail(
            ExitCode::usage,
            fmt::format("a window of {} cycles of {} Hz is {} samples at {} Hz, not a whole number", cycles.to_string(),
                        frequency_hz.to_string(), samples.to_string(), rate_hz.to_string()),
            "choose a sampling rate that is a multiple of the frequency (4800 Hz for 60 Hz, 4000 Hz for 50 Hz)");
    }
    if (samples.num() < 4 || samples.num() > 100'000) {
        return fail(ExitCode::usage, fmt::format("a window of {} samples", samples.num()), "4 to 100000 are possible");
    }
    return static_cast<int>(samples.num());
}

DifferentialElement::DifferentialElement(ElementParams const& params)
    : params_{params}, rows_(2 * static_cast<std::size_t>(params.window_samples)) {
    assert(params.window_samples > 0 && params.samples_per_cycle > 0);
    if (params.kind == ElementParams::Kind::phasor) {
        for (int i = 0; i < params.window_samples; ++i) {
            double const angle = 2 * 3.141592653589793 * i / params.samples_per_cycle;
            cos_.push_back(elementary::cos(angle));
            sin_.push_back(elementary::sin(angle));
        }
    }
}

void DifferentialElement::push(Abc const& from_into_a, Abc const& to_into_a) {
    Row const row{from_into_a[0], from_into_a[1], from_into_a[2], to_into_a[0], to_into_a[1], to_into_a[2]};
    auto const at = static_cast<std::size_t>(next_);
    rows_[at] = row;
    rows_[at + static_cast<std::size_t>(params_.window_samples)] = row;
    next_ = next_ + 1 == params_.window_samples ? 0 : next_ + 1;
    filled_ = std::min(filled_ + 1, params_.window_samples);
}

ElementValues DifferentialElement::evaluate() const {
    assert(full());
    Row const* const window = &rows_[static_cast<std::size_t>(next_)]; // oldest sample
    return params_.kind == ElementParams::Kind::rms ? evaluate_rms(window) : evaluate_phasor(window);
}

ElementValues DifferentialElement::evaluate_rms(Row const* window) const {
    Row sum{};
    for (int i = 0; i < params_.window_samples; ++i) {
        for (std::size_t c = 0; c < 6; ++c) {
            sum[c] += window[i][c] * window[i][c];
        }
    }
    ElementValues v;
    for (std::size_t p = 0; p < 3; ++p) {
        v.from_a[p] = std::sqrt(sum[p] / params_.window_samples);
        v.to_a[p] = std::sqrt(sum[p + 3] / params_.window_samples);
        v.differential_a[p] = std::fabs(v.from_a[p] - v.to_a[p]); // Eq. (5)
        v.restraint_a[p] = (v.from_a[p] + v.to_a[p]) / 2;
    }
    decide(v);
    return v;
}

ElementValues DifferentialElement::evaluate_phasor(Row const* window) const {
    Row re{}, im{};
    for (int i = 0; i < params_.window_samples; ++i) {
        double const c = cos_[static_cast<std::size_t>(i)], s = sin_[static_cast<std::size_t>(i)];
        for (std::size_t k = 0; k < 6; ++k) {
            re[k] += window[i][k] * c;
            im[k] -= window[i][k] * s;
        }
    }
    double const to_rms = std::sqrt(2.0) / params_.window_samples;
    ElementValues v;
    for (std::size_t p = 0; p < 3; ++p) {
        v.from_a[p] = std::sqrt(re[p] * re[p] + im[p] * im[p]) * to_rms;
        v.to_a[p] = std::sqrt(re[p + 3] * re[p + 3] + im[p + 3] * im[p + 3]) * to_rms;
        double const sum_re = re[p] + re[p + 3], sum_im = im[p] + im[p + 3];
        v.differential_a[p] = std::sqrt(sum_re * sum_re + sum_im * sum_im) * to_rms;
        v.restraint_a[p] = (v.from_a[p] + v.to_a[p]) / 2;
    }
    decide(v);
    return v;
}

double operating_current_a(ElementParams const& params, double restraint_a) {
    if (params.kind != ElementParams::Kind::phasor) {
        return params.pickup_a;
    }
    double restrained = params.slope_percent / 100 * restraint_a;
    if (params.slope2_percent > 0 && restraint_a > params.slope2_from_a) {
        restrained = params.slope_percent / 100 * params.slope2_from_a +
                     params.slope2_percent / 100 * (restraint_a - params.slope2_from_a);
    }
    return std::max(params.pickup_a, restrained);
}

void DifferentialElement::decide(ElementValues& v) const {
    for (std::size_t p = 0; p < 3; ++p) {
        double const needed = operating_current_a(params_, v.restraint_a[p]);
        v.operate_at_a[p] = needed;
        if (v.differential_a[p] >= needed) { // Eq. (6); false for anything that is not a number
            v.pickup_phases = static_cast<std::uint8_t>(v.pickup_phases | (1U << p));
        }
    }
}

} // namespace gridspace::relay

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/scan/stream_forecast.hpp"

namespace gridspace::scan {

void StreamForecast::add(std::int64_t index, relay::EndSample const& sample, Place at) {
    Sample const one{index, sample.i_a, sample.validity != relay::Validity::invalid, at};
    meter_.add(index, sample.i_a[0]);
    if (guard_) {
        judge(one);
        return;
    }
    first_.see(sample.i_a);
    if (!first_.wait(one)) {
        begin();
    }
}

void StreamForecast::begin() {
    nominal_peak_a_ = nominal_peak_a_ > 0 ? nominal_peak_a_ : first_.peak_a();
    auto const params = detector_params(model_, ids::Mode::monitor, nominal_peak_a_);
    if (!params) {
        nominal_peak_a_ = 0;
        (void)first_.take();
        return; // no current yet
    }
    guard_.emplace(model_, params->guard);
    for (Sample const& sample : first_.take()) {
        judge(sample);
    }
}

void StreamForecast::judge(Sample const& sample) {
    ids::StreamVerdict const& v =
        sample.usable ? guard_->step(sample.index, sample.i_a) : guard_->step_lost(sample.index, sample.i_a);
    if (v.ready && v.any_open_flagged()) {
        ++flagged_;
        alarms_.raise("off_forecast", sample.at);
    }
}

void StreamForecast::finish() {
    if (!guard_) {
        begin();
    }
}

ForecastResult StreamForecast::result() const {
    ForecastResult out;
    out.why_not = misfit(model_.rate_hz / model_.frequency_hz, meter_.cycles());
    if (!guard_ || !out.why_not.empty()) {
        out.why_not = out.why_not.empty() ? "no current" : out.why_not;
        return out;
    }
    out.samples = guard_->counters().samples;
    out.flagged = flagged_;
    out.sigma_percent = guard_->sigma_percent();
    out.nominal_peak_a = nominal_peak_a_;
    return out;
}

} // namespace gridspace::scan

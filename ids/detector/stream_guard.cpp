// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/detector/stream_guard.hpp"

#include <cmath>

namespace gridspace::ids {
namespace {

/// How many flagged samples in a row a mode replaces.
int replaceable(GuardParams const& p) {
    switch (p.mode) {
    case Mode::paper:
        return -1; // no limit
    case Mode::hold_off:
        return p.hold_off_samples;
    case Mode::supervise:
    case Mode::monitor:
        return 0;
    }
    return 0;
}

} // namespace

StreamGuard::Loop::Loop(Model const& model, GuardParams const& params)
    : history{model.window}, forecaster{model},
      thresholds{Threshold{params.threshold}, Threshold{params.threshold}, Threshold{params.threshold}},
      believed{RunningPeak{params.threshold.peak_samples}, RunningPeak{params.threshold.peak_samples},
               RunningPeak{params.threshold.peak_samples}} {}

StreamGuard::StreamGuard(Model const& model, GuardParams const& params)
    : params_{params}, closed_{model, params}, open_{model, params}, raw_{model.window} {}

void StreamGuard::predict(Loop& loop) {
    loop.forecaster.forecast_phases(loop.history.phase(0), loop.next.data());
    for (std::size_t p = 0; p < 3; ++p) {
        double const bound = params_.clamp * std::max(params_.threshold.nominal_peak_a, loop.believed[p].value());
        loop.next[p] = std::min(std::max(loop.next[p], -bound), bound);
    }
}

StreamVerdict const& StreamGuard::step(std::int64_t index, Abc const& raw_a) {
    if (!std::isfinite(raw_a[0]) || !std::isfinite(raw_a[1]) || !std::isfinite(raw_a[2])) {
        return step_lost(index, raw_a);
    }
    if (started_ && index <= last_index_) {
        return verdict_;
    }
    if (started_) {
        fill(index - last_index_ - 1 + lost_run_);
    }
    lost_run_ = 0;
    started_ = true;
    last_index_ = index;
    verdict_.index = index;
    verdict_.ready = closed_.history.full();
    if (verdict_.ready) {
        predict(closed_);
        predict(open_);
        ++counters_.samples;
    }
    Abc accepted = raw_a, open_accepted = raw_a;
    int const limit = replaceable(params_);
    std::array<bool, 3> rebuild{};
    for (std::size_t p = 0; p < 3; ++p) {
        ChannelVerdict v{raw_a[p], raw_a[p], raw_a[p], closed_.thresholds[p].limit_a(raw_a[p]), false, raw_a[p], false};
        double error = -1, open_error = -1;
        if (verdict_.ready) {
            v.forecast_a = closed_.next[p];
            error = std::fabs(raw_a[p] - v.forecast_a);
            v.flagged = !(error <= v.limit_a);
            closed_.run[p] = v.flagged ? closed_.run[p] + 1 : 0;
            if (v.flagged && (limit < 0 || closed_.run[p] <= limit)) {
                v.accepted_a = accepted[p] = v.forecast_a;
                ++counters_.replaced;
            } else if (v.flagged && limit > 0) {
                rebuild[p] = true; // the samples before were true after all
            }
            v.open_forecast_a = open_.next[p];
            open_error = std::fabs(raw_a[p] - v.open_forecast_a);
            v.open_flagged = !(open_error <= open_.thresholds[p].limit_a(raw_a[p]));
            open_.run[p] = v.open_flagged ? open_.run[p] + 1 : 0;
            if (open_.run[p] == 1) {
                open_accepted[p] = v.open_forecast_a;
            }
        }
        if (v.accepted_a == raw_a[p]) {
            closed_.believed[p].push(raw_a[p]);
        }
        if (open_accepted[p] == raw_a[p]) {
            open_.believed[p].push(raw_a[p]);
        }
        closed_.thresholds[p].update(v.accepted_a, error);
        open_.thresholds[p].update(open_accepted[p], open_error);
        verdict_.phases[p] = v;
    }
    raw_.push(raw_a[0], raw_a[1], raw_a[2]);
    closed_.history.push(accepted[0], accepted[1], accepted[2]);
    open_.history.push(open_accepted[0], open_accepted[1], open_accepted[2]);
    for (std::size_t p = 0; p < 3; ++p) {
        if (rebuild[p]) {
            closed_.history.copy_phase(raw_, p);
        }
        if (open_.run[p] >= 2) {
            open_.history.copy_phase(raw_, p);
        }
    }
    if (verdict_.ready) {
        bool const flagged = verdict_.any_flagged();
        counters_.flagged += flagged ? 1U : 0U;
        counters_.open_flagged += verdict_.any_open_flagged() ? 1U : 0U;
        remember(flagged);
    }
    return verdict_;
}

StreamVerdict const& StreamGuard::step_lost(std::int64_t index, Abc const& raw_a) {
    if (started_ && index <= last_index_) {
        return verdict_;
    }
    lost_run_ += static_cast<int>(std::min<std::int64_t>(started_ ? index - last_index_ : 1, params_.max_filled + 1));
    ++counters_.unusable;
    started_ = true;
    last_index_ = index;
    verdict_.index = index;
    verdict_.ready = false;
    for (std::size_t p = 0; p < 3; ++p) {
        verdict_.phases[p] = {raw_a[p], raw_a[p], raw_a[p], 0, false, raw_a[p], false};
    }
    if (lost_run_ > params_.max_filled) {
        restart();
    }
    return verdict_;
}

/// Puts forecasts in the place of lost samples, so that the window is not shifted.
void StreamGuard::fill(std::int64_t missing) {
    if (missing <= 0) {
        return;
    }
    if (missing > params_.max_filled || !closed_.history.full()) {
        restart();
        return;
    }
    for (; missing > 0; --missing) {
        predict(closed_);
        predict(open_);
        closed_.history.push(closed_.next[0], closed_.next[1], closed_.next[2]);
        open_.history.push(open_.next[0], open_.next[1], open_.next[2]);
        raw_.push(closed_.next[0], closed_.next[1], closed_.next[2]);
        ++counters_.filled;
    }
}

void StreamGuard::restart() {
    counters_.restarts += closed_.history.empty() ? 0U : 1U;
    closed_.history.clear();
    open_.history.clear();
    raw_.clear();
    closed_.run = open_.run = {};
    for (std::size_t p = 0; p < 3; ++p) {
        closed_.thresholds[p].clear();
        open_.thresholds[p].clear();
        closed_.believed[p].clear();
        open_.believed[p].clear();
    }
    recent_.fill(false);
    recent_flagged_ = 0;
}

void StreamGuard::remember(bool flagged) {
    auto const at = static_cast<std::size_t>(recent_next_);
    recent_flagged_ += (flagged ? 1 : 0) - (recent_[at] ? 1 : 0);
    recent_[at] = flagged;
    recent_next_ = recent_next_ + 1 == kRecent ? 0 : recent_next_ + 1;
}

double StreamGuard::sigma_percent() const {
    double out = 0;
    for (Threshold const& t : closed_.thresholds) {
        out = t.settled() ? std::max(out, t.sigma_percent()) : out;
    }
    return out;
}

double StreamGuard::base_a() const {
    return std::max({closed_.thresholds[0].base_a(), closed_.thresholds[1].base_a(), closed_.thresholds[2].base_a()});
}

} // namespace gridspace::ids

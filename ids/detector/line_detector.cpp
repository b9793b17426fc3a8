// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/detector/line_detector.hpp"

#include <cmath>
#include <utility>

namespace gridspace::ids {

namespace {

/// 0: no phase flagged, 1: flagged, 2: beyond twice the limit.
int flags(StreamVerdict const& v) {
    int out = 0;
    for (ChannelVerdict const& c : v.phases) {
        if (c.flagged) {
            out = std::max(out, std::fabs(c.raw_a - c.forecast_a) > 2 * c.limit_a ? 2 : 1);
        }
    }
    return out;
}

} // namespace

std::string alarm_names(Alarms alarms) {
    static constexpr std::array<std::pair<Alarm, char const*>, 7> kNames{{{kFlagged, "flagged"},
                                                                          {kOneEnd, "one_end"},
                                                                          {kUnconfirmed, "unconfirmed"},
                                                                          {kNoise, "noise"},
                                                                          {kLockedOut, "locked_out"},
                                                                          {kNotArmed, "not_armed"},
                                                                          {kMeasuringChain, "measuring_chain"}}};
    std::string out;
    for (auto const& [bit, name] : kNames) {
        if ((alarms & bit) != 0) {
            out += (out.empty() ? "" : ", ") + std::string{name};
        }
    }
    return out;
}

LineDetector::LineDetector(Model const& model, DetectorParams const& params)
    : params_{params}, from_{model, params.guard}, to_{model, params.guard}, supervisor_{params.supervisor},
      standing_{params.standing} {}

LineVerdict const& LineDetector::step(std::int64_t index, EndInput const& from, EndInput const& to, bool picked_up) {
    StreamVerdict const& f = from.usable ? from_.step(index, from.i_a) : from_.step_lost(index, from.i_a);
    StreamVerdict const& t = to.usable ? to_.step(index, to.i_a) : to_.step_lost(index, to.i_a);
    Mode const mode = params_.guard.mode;
    verdict_.index = index;
    verdict_.from_accepted_a = params_.guard_from ? f.accepted_a() : from.i_a;
    verdict_.to_accepted_a = params_.guard_to ? t.accepted_a() : to.i_a;
    double const sign = params_.along_the_line ? -1 : 1;
    for (std::size_t p = 0; p < 3; ++p) {
        verdict_.difference_a[p] = from.i_a[p] + sign * to.i_a[p];
    }
    if (mode == Mode::supervise) {
        Supervisor::Input in;
        in.usable = f.ready && t.ready;
        in.from_flags = flags(f);
        in.to_flags = flags(t);
        double const limit = params_.supervisor.kirchhoff_percent / 100 * std::max(from_.base_a(), to_.base_a());
        Abc remaining = verdict_.difference_a;
        if (in.usable) {
            bool const disturbed = in.from_flags > 0 && in.to_flags > 0;
            remaining = standing_.step(
                {index, verdict_.difference_a, from.i_a, std::max(from_.base_a(), to_.base_a()), limit, disturbed});
        }
        for (std::size_t p = 0; p < 3; ++p) {
            bool const differs = !(std::fabs(remaining[p]) <= limit);
            in.differs = in.differs || differs;
            in.same_phase_alone = in.same_phase_alone || (differs && f.phases[p].flagged != t.phases[p].flagged);
        }
        supervisor_.step(index, in, picked_up);
        verdict_.confirmed = supervisor_.confirmed();
        verdict_.granted = supervisor_.granted();
    } else if ((params_.guard_from && f.any_flagged()) || (params_.guard_to && t.any_flagged())) {
        last_flag_ = index;
    }
    Alarms const before = verdict_.alarms;
    verdict_.alarms = present_alarms(picked_up);
    verdict_.alarm_rose = before == 0 && verdict_.alarms != 0;
    alarms_ += verdict_.alarm_rose ? 1U : 0U;
    return verdict_;
}

Alarms LineDetector::present_alarms(bool picked_up) {
    Alarms out = 0;
    SupervisorParams const& s = params_.supervisor;
    if (params_.guard.mode == Mode::supervise) {
        out |= supervisor_.suspicious() ? static_cast<Alarms>(kOneEnd) : 0U;
        out |= standing_.beyond_classes() || standing_.moved() ? static_cast<Alarms>(kMeasuringChain) : 0U;
        out |= supervisor_.armed() ? 0U : static_cast<Alarms>(kNotArmed);
        out |= picked_up && !supervisor_.confirmed() ? static_cast<Alarms>(kUnconfirmed) : 0U;
    } else {
        out |= verdict_.index - last_flag_ < s.hold_samples ? static_cast<Alarms>(kFlagged) : 0U;
    }
    if (params_.guard.mode == Mode::paper) {
        out |= from_.locked_out() || to_.locked_out() ? static_cast<Alarms>(kLockedOut) : 0U;
    }
    if (params_.guard.threshold.of == ThresholdParams::Of::adaptive) {
        double const sigma = std::max(from_.sigma_percent(), to_.sigma_percent());
        noisy_ = sigma > s.noise_alarm_percent * (noisy_ ? 0.9 : 1);
        out |= noisy_ ? static_cast<Alarms>(kNoise) : 0U;
    }
    return out;
}

void LineDetector::restart() {
    from_.restart();
    to_.restart();
    supervisor_.restart();
    standing_.restart();
    verdict_ = {};
    noisy_ = false;
    last_flag_ = INT64_MIN / 4;
}

} // namespace gridspace::ids

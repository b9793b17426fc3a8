// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/detector/supervisor.hpp"

#include <algorithm>
#include <cstdlib>

namespace gridspace::ids {
namespace {

/// Shifts `flags` (0, 1 or 2) into the record of the last samples; the sum of the last `window`.
int recent(std::uint32_t& record, int flags, int window) {
    record = (record << 2U) | static_cast<std::uint32_t>(flags);
    int sum = 0;
    for (int k = 0; k < window; ++k) {
        sum += static_cast<int>((record >> static_cast<unsigned>(2 * k)) & 3U);
    }
    return sum;
}

} // namespace

void Supervisor::step(std::int64_t index, Input const& in, bool picked_up) {
    now_ = index;
    pickup_run_ = picked_up ? std::min(pickup_run_ + 1, params_.delay_samples) : 0;
    timed_out_ =
        params_.on_unconfirmed == SupervisorParams::OnUnconfirmed::delay && pickup_run_ >= params_.delay_samples;
    if (!in.usable) {
        return; // no evidence either way
    }
    int const from = recent(from_bits_, in.from_flags, params_.burst_window);
    int const to = recent(to_bits_, in.to_flags, params_.burst_window);
    from_burst_ = from >= params_.burst_count ? now_ : from_burst_;
    to_burst_ = to >= params_.burst_count ? now_ : to_burst_;
    from_flag_ = in.from_flags > 0 && from >= params_.weak_end_count ? now_ : from_flag_;
    to_flag_ = in.to_flags > 0 && to >= params_.weak_end_count ? now_ : to_flag_;
    auto const both = [&](std::int64_t burst, std::int64_t flag) {
        return std::max(burst, flag) == now_ && std::llabs(burst - flag) <= params_.both_ends_within;
    };
    if (both(from_burst_, to_flag_) || both(to_burst_, from_flag_)) {
        onset_ = now_;
    }
    // "First" is judged by the clean samples before this run of differences, so they are counted up to its first
    // sample.
    bool const differs = recent(differ_bits_, in.differs ? 1 : 0, params_.burst_window) >= params_.burst_count;
    if (differs && !differing_ && clean_ >= params_.kirchhoff_clean) {
        first_difference_ = now_;
    }
    differing_ = differs;
    if (in.differs) {
        last_difference_ = now_;
    }
    if (differs) {
        clean_ = 0;
    } else if (!in.differs) {
        clean_ = std::min(clean_ + 1, params_.kirchhoff_clean);
    }
    unarmed_ = clean_ >= params_.kirchhoff_clean ? 0 : std::min(unarmed_ + 1, params_.armed_within);
    if (std::max(onset_, first_difference_) == now_ &&
        std::llabs(onset_ - first_difference_) <= params_.synchronous_within) {
        permitted_until_ = now_ + params_.hold_samples;
    }
    look_for_forgery(in);
}

/// A doubt is a difference of the ends with a change at one of them only. When no onset at both ends follows within
/// `synchronous_within`, it becomes an alarm.
void Supervisor::look_for_forgery(Input const& in) {
    bool const doubt = in.same_phase_alone || first_difference_ == now_;
    if (doubt && doubt_since_ == kNever && !confirmed() && now_ - onset_ > params_.synchronous_within) {
        doubt_since_ = now_;
    }
    if (doubt_since_ != kNever) {
        if (onset_ >= doubt_since_ - params_.synchronous_within) {
            doubt_since_ = kNever;
        } else if (now_ - doubt_since_ >= params_.synchronous_within) {
            alarms_ += suspicious_ ? 0U : 1U;
            suspicious_ = true;
            last_doubt_ = now_;
            doubt_since_ = kNever;
        }
    }
    if (suspicious_ && (differing_ && !confirmed())) {
        last_doubt_ = now_;
    }
    if (suspicious_ && now_ - last_doubt_ > params_.hold_samples) {
        suspicious_ = false;
    }
}

void Supervisor::restart() {
    std::uint64_t const alarms = alarms_;
    *this = Supervisor{params_};
    alarms_ = alarms;
}

} // namespace gridspace::ids

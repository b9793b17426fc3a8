// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/ptp/time_quality.hpp"

#include <cstdlib>
#include <fmt/format.h>

namespace gridspace::ptp {
namespace {

constexpr std::uint8_t kNone = 0, kLocal = 1, kGlobal = 2;

/// IEEE 1588, table 5: 6 follows a primary reference, 7 has lost it and is within its specification.
bool is_traceable(std::uint8_t clock_class) {
    return clock_class == 6 || clock_class == 7;
}
/// 13 and 14 are the same for a time that somebody set: who is the clock of an area says so. 248 and the like only say
/// that nobody better was there.
bool is_a_time_source(std::uint8_t clock_class) {
    return is_traceable(clock_class) || clock_class == 13 || clock_class == 14;
}

std::string text_of(ClockIdentity const& id) {
    return fmt::format("{:02x}{:02x}{:02x}.{:02x}{:02x}.{:02x}{:02x}{:02x}", id[0], id[1], id[2], id[3], id[4], id[5],
                       id[6], id[7]);
}

} // namespace

void TimeQuality::hear(ManagementResponse const& response, std::int64_t now_ns) {
    own_ = response.from;
    if (response.time_status) {
        if (!status_ || status_->ingress_ns != response.time_status->ingress_ns) {
            measured_ns_ = now_ns;
        }
        status_ = response.time_status;
        status_ns_ = now_ns;
    }
    if (response.parent) {
        parent_ = response.parent;
        parent_ns_ = now_ns;
    }
}

std::uint8_t TimeQuality::heard_synch(std::int64_t now_ns) const {
    bool const answers = status_ && parent_ && now_ns - status_ns_ <= params_.answers_within_ns &&
                         now_ns - parent_ns_ <= params_.answers_within_ns;
    if (!answers || status_->grandmaster != parent_->grandmaster) { // asked one after the other
        return kNone;
    }
    std::uint8_t const said = is_traceable(parent_->clock_class) ? kGlobal : kLocal;
    if (status_->grandmaster_present) {
        bool const is_measured = status_->ingress_ns != 0 && now_ns - measured_ns_ <= kMeasuresWithinNs;
        return is_measured && std::llabs(status_->master_offset_ns) <= params_.within_ns ? said : kNone;
    }
    return parent_->grandmaster == own_ && is_a_time_source(parent_->clock_class) ? said : kNone;
}

bool TimeQuality::look(std::int64_t now_ns) {
    State const before = state_;
    std::uint8_t const said_before = smp_synch_;
    answers_ = status_ && now_ns - status_ns_ <= params_.answers_within_ns;
    if (std::uint8_t const heard = heard_synch(now_ns); heard != kNone) {
        state_ = State::following;
        smp_synch_ = heard;
        good_ns_ = now_ns;
    } else if (state_ != State::never) {
        state_ = now_ns - good_ns_ <= params_.holdover_ns ? State::holdover : State::lost;
        smp_synch_ = state_ == State::lost ? kNone : smp_synch_;
    } else if (!told_ && now_ns - began_ns_.value_or(now_ns) >= kPatienceNs) {
        told_ = true;
        return true;
    }
    began_ns_ = began_ns_.value_or(now_ns);
    return state_ != before || smp_synch_ != said_before;
}

std::string TimeQuality::text() const {
    std::string const offset =
        fmt::format("{:.3f} us", status_ ? static_cast<double>(status_->master_offset_ns) / 1e3 : 0);
    if (state_ == State::following) {
        return fmt::format("{} clock {} (class {}), {} away: smpSynch is {}",
                           status_->grandmaster_present ? "follows" : "is", text_of(parent_->grandmaster),
                           parent_->clock_class, offset, smp_synch_);
    }
    std::string const why = !answers_                       ? "the PTP daemon does not answer"
                            : !status_->grandmaster_present ? "no grandmaster"
                            : std::llabs(status_->master_offset_ns) > params_.within_ns
                                ? offset + " from its grandmaster"
                                : "its grandmaster sends no time";
    char const* const then = state_ == State::holdover ? "holdover"
                             : state_ == State::lost   ? "not synchronised any more"
                                                       : "not synchronised yet";
    return fmt::format("{}, {}: smpSynch is {}", why, then, smp_synch_);
}

} // namespace gridspace::ptp

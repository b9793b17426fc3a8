// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/sv_subscriber.hpp"

#include <cmath>

namespace gridspace::iec61850 {
namespace {

constexpr std::uint32_t kWholeCounter = 65536;
constexpr std::uint32_t kFewLost = 3;
constexpr std::int64_t kNear = 16;        ///< steps of the counter that need no explanation
constexpr std::uint32_t kRunToLearn = 16; ///< a peer that restarts at 0 in every frame must not teach us a wrap

constexpr std::array<std::string_view, kSvEvents> kNames{"first",         "in_order",          "lost",
                                                         "restart",       "duplicate",         "late",
                                                         "unconfirmed",   "identity_mismatch", "conf_rev_mismatch",
                                                         "size_mismatch", "simulation_refused"};

/// The number congruent to `value` modulo `wrap` that is nearest to `near`.
std::int64_t nearest_congruent(std::int64_t value, std::int64_t wrap, std::int64_t near) noexcept {
    std::int64_t difference = (value - near) % wrap;
    if (difference < 0) {
        difference += wrap;
    }
    return near + difference - (2 * difference > wrap ? wrap : 0);
}

/// The wrap of a counter that went from `last` to `next`, which is less; 0: that was no wrap, its publisher began anew.
/// A second holds whole periods of 50 or 60 Hz; or the wrap is what the arrivals say (which may run faster or slower
/// than the grid); or it is the end of 16 bits. With a few samples lost just there only the rates in use are believed,
/// which are multiples of 160.
std::uint32_t wrap_between(std::uint32_t last, std::uint32_t next, double arrivals_hz) noexcept {
    std::uint32_t const wrap = last + 1;
    if (next == 0 && (wrap % 50 == 0 || wrap % 60 == 0 || wrap >= kWholeCounter - 1)) {
        return wrap;
    }
    for (std::uint32_t lost = 0; next <= kFewLost && lost <= kFewLost; ++lost) {
        if ((wrap + lost) % 160 == 0) {
            return wrap + lost;
        }
    }
    if (next == 0 && std::abs(arrivals_hz - wrap) < 0.02 * wrap) {
        return wrap;
    }
    return 0;
}

} // namespace

std::string_view event_name(SvEvent event) noexcept {
    return kNames[static_cast<std::size_t>(event)];
}

SvSubscriber::SvSubscriber(SvSubscription subscription)
    : subscription_{std::move(subscription)}, wrap_{subscription_.wrap == 0 ? kWholeCounter : subscription_.wrap},
      wrap_known_{subscription_.wrap != 0} {}

SvArrival SvSubscriber::count(SvArrival arrival) noexcept {
    ++counters_.events[static_cast<std::size_t>(arrival.event)];
    return arrival;
}

bool SvSubscriber::is_addressed(FrameHeader const& header) const noexcept {
    SvSubscription const& s = subscription_;
    return (!s.destination || header.destination == *s.destination) && (!s.source || header.source == *s.source) &&
           (!s.app_id || header.app_id == *s.app_id);
}

SvArrival SvSubscriber::receive(FrameHeader const& header, Asdu const& asdu, std::int64_t now_ns) noexcept {
    SvSubscription const& s = subscription_;
    auto const refused = [&](SvEvent event) { return count({event, false, 0, index_}); };
    if (!is_addressed(header)) {
        return refused(SvEvent::identity_mismatch);
    }
    if (header.simulated() != s.simulation && (header.simulated() || seen_simulated_)) {
        return refused(SvEvent::simulation_refused);
    }
    if (asdu.conf_rev != s.conf_rev) {
        return refused(SvEvent::conf_rev_mismatch);
    }
    if (s.sample_octets != 0 && asdu.sample.size() != s.sample_octets) {
        return refused(SvEvent::size_mismatch);
    }
    smp_synch_ = asdu.smp_synch;
    seen_simulated_ = header.simulated();
    return receive(asdu.smp_cnt, now_ns);
}

std::int64_t SvSubscriber::index_of(std::uint16_t smp_cnt, std::int64_t now_ns) const noexcept {
    // Where time puts it, when enough of it has passed that the counter alone is ambiguous.
    double const periods = static_cast<double>(now_ns - last_ns_) * 1e-9 * subscription_.rate_hz;
    std::int64_t const near = periods > wrap_ / 2.0 ? index_ + std::llround(periods) : index_ + 1;
    return nearest_congruent(smp_cnt, wrap_, near);
}

void SvSubscriber::learn_wrap(std::uint16_t smp_cnt) noexcept {
    if (wrap_known_ || smp_cnt >= last_cnt_ || run_ < kRunToLearn) {
        return;
    }
    if (std::uint32_t const wrap = wrap_between(last_cnt_, smp_cnt, arrivals_.rate_hz()); wrap != 0) {
        wrap_ = wrap;
        wrap_known_ = true;
        index_ = last_cnt_;
        arrivals_.clear(); // its indices were counted with another wrap
    }
}

/// Farther from the last sample than a few lost or late ones, and than the time since then explains.
bool SvSubscriber::is_jump(std::uint16_t smp_cnt, std::int64_t now_ns) const noexcept {
    if (wrap_known_ && smp_cnt >= wrap_) {
        return true;
    }
    std::int64_t const step = index_of(smp_cnt, now_ns) - index_;
    if (step <= kNear && -step <= std::int64_t{subscription_.late_window}) {
        return false;
    }
    double const periods = static_cast<double>(now_ns - last_ns_) * 1e-9 * subscription_.rate_hz;
    return step < 0 || std::abs(periods - static_cast<double>(step)) > static_cast<double>(kNear + step / 8);
}

bool SvSubscriber::goes_on_from_jump(std::uint16_t smp_cnt) const noexcept {
    if (!jumped_to_) {
        return false;
    }
    bool const inside = wrap_known_ && smp_cnt < wrap_ && *jumped_to_ < wrap_;
    std::uint32_t const wrap = inside ? wrap_ : kWholeCounter;
    std::uint32_t const step = (smp_cnt + wrap - *jumped_to_) % wrap;
    return step >= 1 && step <= kFewLost;
}

SvArrival SvSubscriber::receive(std::uint16_t smp_cnt, std::int64_t now_ns) noexcept {
    learn_wrap(smp_cnt);
    bool const confirmed = goes_on_from_jump(smp_cnt);
    if (started_ && !confirmed && is_jump(smp_cnt, now_ns)) {
        jumped_to_ = smp_cnt;
        return count({SvEvent::unconfirmed, false, 0, index_});
    }
    SvArrival arrival;
    if (wrap_known_ && smp_cnt >= wrap_) {
        wrap_known_ = false; // it was learned wrongly, or the stream is not what was configured
        wrap_ = kWholeCounter;
    }
    if (!started_) {
        started_ = true;
        arrival = {SvEvent::first, true, 0, smp_cnt};
    } else {
        std::int64_t const index = index_of(smp_cnt, now_ns);
        std::int64_t const step = index - index_;
        if (step == 1) {
            arrival = {SvEvent::in_order, true, 0, index};
        } else if (step == 0) {
            return count({SvEvent::duplicate, false, 0, index});
        } else if (step < 0 && -step <= std::int64_t{subscription_.late_window}) {
            return count({SvEvent::late, false, 0, index});
        } else if (step > 0 && step - 1 <= std::int64_t{subscription_.max_gap}) {
            arrival = {SvEvent::lost, true, static_cast<std::uint32_t>(step - (confirmed ? 2 : 1)), index};
        } else { // indices never go back
            arrival = {SvEvent::restart, true, 0,
                       step > 0 ? index : index + std::int64_t{wrap_} * ((-step) / wrap_ + 1)};
        }
    }
    run_ = arrival.event == SvEvent::in_order ? run_ + 1 : 0;
    if (arrival.event == SvEvent::restart) {
        arrivals_.clear();
    }
    silent_ = false;
    jumped_to_.reset();
    index_ = arrival.index;
    last_cnt_ = smp_cnt;
    last_ns_ = now_ns;
    ++counters_.samples;
    counters_.lost += arrival.lost;
    arrivals_.add(index_, now_ns);
    arrival.accepted = true;
    return count(arrival);
}

std::optional<std::int64_t> SvSubscriber::deadline() const noexcept {
    if (!alive()) {
        return std::nullopt;
    }
    return last_ns_ + static_cast<std::int64_t>(std::ceil(subscription_.silence_periods * 1e9 / subscription_.rate_hz));
}

bool SvSubscriber::expire(std::int64_t now_ns) noexcept {
    auto const at = deadline();
    if (!at || now_ns < *at) {
        return false;
    }
    silent_ = true;
    ++counters_.silences;
    return true;
}

} // namespace gridspace::iec61850

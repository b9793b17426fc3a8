// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/sv_subscriber.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace gridspace::iec61850 {
namespace {

constexpr std::uint32_t kWholeCounter = 65536;
constexpr std::uint32_t kFewLost = 3;
constexpr std::int64_t kRemembered = 64;  ///< samples of which is known whether they came
constexpr std::int64_t kNear = 16;        ///< steps of the counter that need no explanation
constexpr std::uint32_t kRunToLearn = 16; ///< a peer that restarts at 0 in every frame must not teach us a wrap
constexpr std::uint64_t kArrivalsForRate = 16;
constexpr std::int64_t kSpanForRateNs = 100'000'000; ///< frames that come in one heap say nothing about the rate

constexpr std::array<std::string_view, kSvEvents> kSvEventNames{
    "first",         "in_order",          "lost",
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
/// which are multiples of 160. `run` samples came in order before: of a few (a second of a slow stream has no more)
/// only the arrivals are believed, of which the one of `next` is the last: `with_next_hz` is their rate. That is coarse
/// (who listens got no processor for a moment), the fewer the more, so it is enough for whole tens, which are what slow
/// streams have.
std::uint32_t wrap_between(std::uint32_t last, std::uint32_t next, double arrivals_hz, double with_next_hz,
                           std::uint32_t run) noexcept {
    std::uint32_t const wrap = last + 1;
    bool const arrivals_say_so = next == 0 && run > 0 && std::abs(arrivals_hz - wrap) < 0.02 * wrap;
    double const off = run < kRunToLearn ? 5 : 1.25;
    bool const about = next == 0 && wrap % 10 == 0 && with_next_hz * off > wrap && with_next_hz < off * wrap;
    if (about || run < kRunToLearn) {
        return about || arrivals_say_so ? wrap : 0;
    }
    if (next == 0 && (wrap % 50 == 0 || wrap % 60 == 0 || wrap >= kWholeCounter - 1)) {
        return wrap;
    }
    for (std::uint32_t lost = 0; next <= kFewLost && lost <= kFewLost; ++lost) {
        if ((wrap + lost) % 160 == 0) {
            return wrap + lost;
        }
    }
    return arrivals_say_so ? wrap : 0;
}

/// The same where the publisher sends in heaps, and paused just between its highest counter and 0; 0 also when samples
/// may be missing there.
std::uint32_t wrap_behind_a_pause(std::uint32_t last, std::uint32_t next, double arrivals_hz,
                                  std::uint32_t run) noexcept {
    std::uint32_t const wrap = last + 1;
    bool const whole = wrap % 50 == 0 || wrap % 60 == 0;
    return next == 0 && whole && run >= kRunToLearn && std::abs(arrivals_hz - wrap) < 0.05 * wrap ? wrap : 0;
}

/// The samples in a second at about `hz`: whole periods of 50 or 60 Hz, or of 10 Hz where few are seen. 0: near none.
std::uint32_t samples_in_a_second(double hz) noexcept {
    double best = 0;
    for (double const unit : {10.0, 50.0, 60.0}) {
        double const samples = std::round(hz / unit) * unit;
        bool const used = (unit == 10.0) == (hz < 1000);
        if (used && std::abs(samples - hz) < std::abs(best - hz)) {
            best = samples;
        }
    }
    return best < kWholeCounter - 1 && std::abs(best - hz) < 0.002 * hz ? static_cast<std::uint32_t>(best) : 0;
}

} // namespace

std::string_view event_name(SvEvent event) noexcept {
    return kSvEventNames[static_cast<std::size_t>(event)];
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

bool SvSubscriber::rate_seen() const noexcept {
    return arrivals_.count() >= kArrivalsForRate && arrivals_.span_ns() >= kSpanForRateNs;
}

/// The configured rate; of an unknown stream its wrap, which is exact, unless its publisher is slower or faster than
/// the clock; then, and before the wrap is known, what the arrivals say.
double SvSubscriber::rate_hz() const noexcept {
    if (subscription_.wrap != 0) {
        return subscription_.rate_hz;
    }
    double const seen = rate_seen() ? arrivals_.rate_hz() : 0;
    if (wrap_known_ && wrap_ < kWholeCounter - 1 && (seen == 0 || std::abs(seen - wrap_) < 0.1 * wrap_)) {
        return wrap_;
    }
    return seen > 0 ? seen : subscription_.rate_hz;
}

/// Periods since the last sample.
double SvSubscriber::periods_until(std::int64_t now_ns) const noexcept {
    return static_cast<double>(now_ns - last_ns_) * 1e-9 * rate_hz();
}

std::int64_t SvSubscriber::index_of(std::uint16_t smp_cnt, std::int64_t now_ns) const noexcept {
    // Where time puts it, when enough of it has passed that the counter alone is ambiguous.
    double const periods = periods_until(now_ns);
    std::int64_t const near = periods > wrap_ / 2.0 ? index_ + std::llround(periods) : index_ + 1;
    return nearest_congruent(smp_cnt, wrap_, near);
}

void SvSubscriber::learn_wrap(std::uint16_t smp_cnt, std::int64_t now_ns) noexcept {
    if (wrap_known_ || !started_) {
        return;
    }
    bool const gap = rate_seen() && periods_until(now_ns) > 2 * kNear; // then the last counter was not the highest
    std::uint32_t wrap =
        smp_cnt >= last_cnt_ ? 0
        : gap                ? wrap_behind_a_pause(last_cnt_, smp_cnt, arrivals_.rate_hz(), run_)
              : wrap_between(last_cnt_, smp_cnt, arrivals_.rate_hz(), arrivals_.rate_hz_with_next(now_ns), run_);
    wrap = wrap == 0 ? wrap_over_gap(smp_cnt, now_ns) : wrap;
    if (wrap == 0) {
        return;
    }
    wrap_ = wrap;
    wrap_known_ = true;
    if (index_ != last_cnt_) { // counted with another wrap
        index_ = last_cnt_;
        arrivals_.clear();
    }
}

/// The wrap of a counter that comes out of a gap where the rate so far puts it, and where a whole counter would not be.
/// 0: it doesn't.
std::uint32_t SvSubscriber::wrap_over_gap(std::uint16_t smp_cnt, std::int64_t now_ns) const noexcept {
    double const until = periods_until(now_ns);
    if (!rate_seen() || until <= kNear) {
        return 0;
    }
    std::int64_t const whole = index_of(smp_cnt, now_ns) - index_;
    if (whole > 0 && std::abs(until - static_cast<double>(whole)) <= static_cast<double>(kNear + whole / 64)) {
        return 0;
    }
    if (whole > 0 && whole <= kNear && until < arrivals_.rate_hz() / 2) {
        return 0; // it goes on: its publisher paused, or sends in heaps
    }
    std::uint32_t const wrap = samples_in_a_second(arrivals_.rate_hz());
    if (wrap == 0 || last_cnt_ >= wrap || smp_cnt >= wrap) {
        return 0;
    }
    std::int64_t const periods = std::llround(static_cast<double>(now_ns - last_ns_) * 1e-9 * wrap);
    std::int64_t const step = nearest_congruent(smp_cnt, wrap, last_cnt_ + periods) - last_cnt_;
    return std::abs(step - periods) <= 2 + std::int64_t{wrap} / 64 ? wrap : 0;
}

/// Whether so many samples fit between the last one and now.
bool SvSubscriber::time_explains(std::int64_t step, std::int64_t now_ns) const noexcept {
    // In a long gap of an unknown stream they may differ by an eighth of a second at most: chance would agree too
    // often.
    std::int64_t const wide = subscription_.wrap == 0 ? std::min(step, std::int64_t{wrap_}) : step;
    return step > 0 &&
           std::abs(periods_until(now_ns) - static_cast<double>(step)) <= static_cast<double>(kNear + wide / 8);
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
    return !time_explains(step, now_ns);
}

/// Of a sample that is taken and `step` away: samples are missing. Otherwise its publisher began anew.
bool SvSubscriber::is_loss(std::int64_t step, std::int64_t now_ns) const noexcept {
    if (subscription_.wrap == 0 && rate_seen()) {
        return step > 0 && (step <= kNear || time_explains(step, now_ns));
    }
    return step > 0 && step - 1 <= std::int64_t{subscription_.max_gap};
}

bool SvSubscriber::goes_on_from_jump(std::uint16_t smp_cnt) const noexcept {
    if (!jumped_to_) {
        return false;
    }
    // Not here: that it is another frame. The samples of one do not speak for each other.
    bool const inside = wrap_known_ && smp_cnt < wrap_ && *jumped_to_ < wrap_;
    std::uint32_t const wrap = inside ? wrap_ : kWholeCounter;
    std::uint32_t const step = (smp_cnt + wrap - *jumped_to_) % wrap;
    return step >= 1 && step <= kFewLost;
}

/// Of the `step` - 1 samples before this one, those that came and were refused because the counter jumped there.
std::uint32_t SvSubscriber::refused_before(bool confirmed, std::int64_t step) const noexcept {
    return confirmed ? static_cast<std::uint32_t>(std::min<std::int64_t>(jump_refused_, step - 1)) : 0;
}

SvArrival SvSubscriber::receive(std::uint16_t smp_cnt, std::int64_t now_ns) noexcept {
    learn_wrap(smp_cnt, now_ns);
    bool const goes_on = goes_on_from_jump(smp_cnt), confirmed = goes_on && now_ns != jumped_at_ns_;
    if (started_ && !confirmed && is_jump(smp_cnt, now_ns)) {
        jump_refused_ = goes_on ? jump_refused_ + 1 : 1;
        jumped_to_ = smp_cnt;
        jumped_at_ns_ = now_ns;
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
        } else if (step <= 0 && -step <= std::int64_t{subscription_.late_window}) {
            return count(behind(index));
        } else if (is_loss(step, now_ns)) {
            arrival = {SvEvent::lost, true, static_cast<std::uint32_t>(step - 1) - refused_before(confirmed, step),
                       index};
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
    move_on(arrival, confirmed);
    index_ = arrival.index;
    last_cnt_ = smp_cnt;
    last_ns_ = now_ns;
    ++counters_.samples;
    counters_.lost += arrival.lost;
    arrivals_.add(index_, now_ns);
    arrival.accepted = true;
    return count(arrival);
}

/// Remembers which samples came, before the newest one becomes `arrival`.
void SvSubscriber::move_on(SvArrival const& arrival, bool one_was_refused) noexcept {
    std::int64_t const step = arrival.index - index_;
    if (arrival.event == SvEvent::first || arrival.event == SvEvent::restart || step >= kRemembered) {
        seen_ = missing_ = 0;
    } else {
        seen_ <<= step;
        missing_ <<= step;
    }
    if (arrival.event == SvEvent::lost && !one_was_refused) {
        std::int64_t const window = std::min(std::int64_t{subscription_.late_window}, kRemembered - 1);
        std::int64_t const still = std::min(step - 1, window); // bits 1 to `still`
        missing_ |= ((std::uint64_t{1} << still) - 1) << 1U;
    }
    seen_ |= 1;
}

/// A sample that is not newer than the newest one, and not far behind it.
SvArrival SvSubscriber::behind(std::int64_t index) noexcept {
    std::int64_t const back = index_ - index;
    std::uint64_t const bit = back < kRemembered ? std::uint64_t{1} << back : 0;
    if ((seen_ & bit) != 0) {
        return {SvEvent::duplicate, false, 0, index};
    }
    counters_.lost -= (missing_ & bit) != 0 ? 1U : 0U;
    missing_ &= ~bit;
    seen_ |= bit;
    return {SvEvent::late, false, 0, index};
}

std::uint64_t SvSubscriber::lost_for_good() const noexcept {
    std::uint32_t const window = std::min<std::uint32_t>(subscription_.late_window, kRemembered - 1);
    std::uint64_t const within = (std::uint64_t{2} << window) - 1; // all of them for 63
    return counters_.lost - static_cast<std::uint64_t>(std::popcount(missing_ & within));
}

std::optional<std::int64_t> SvSubscriber::deadline() const noexcept {
    if (!alive()) {
        return std::nullopt;
    }
    return last_ns_ + static_cast<std::int64_t>(std::ceil(subscription_.silence_periods * 1e9 / rate_hz()));
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

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/line_relay.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::relay {
namespace {

constexpr double kImplausibleA = 1e9;
constexpr BlockReasons kSynchReasons = kFromSynch | kToSynch, kTestReasons = kFromTest | kToTest;

bool plausible(Abc const& i) {
    return std::fabs(i[0]) <= kImplausibleA && std::fabs(i[1]) <= kImplausibleA && std::fabs(i[2]) <= kImplausibleA;
}

/// What is wrong with one end, as the bits of the `from` end; the bits of the `to` end are twice as large.
BlockReasons wrong_with(EndSample const& s, RelayParams const& params) {
    if (!s.present) {
        return kFromLost;
    }
    BlockReasons out = 0;
    if (!plausible(s.i_a) || !plausible(s.v_v) || s.validity == Validity::invalid ||
        (s.validity == Validity::questionable && !params.accept_questionable)) {
        out |= kFromQuality;
    }
    if ((s.test || s.simulated) && !params.test_mode) {
        out |= kFromTest;
    }
    if (s.synch < params.required_synch) {
        out |= kFromSynch;
    }
    return out;
}

} // namespace

bool usable(EndSample const& sample, RelayParams const& params) {
    return wrong_with(sample, params) == 0;
}

LineRelay::LineRelay(RelayParams const& params)
    : params_{params}, element_{params.element}, events_{params.event_capacity} {
    output_.blocked = said_ = kFilling; // every relay begins so: nothing to report
}

RelayOutput const& LineRelay::step(LineSample const& sample, TripPermission permission) {
    if (started_ && sample.index <= last_index_) {
        ++counters_.stale;
        return output_;
    }
    if (started_ && sample.index - last_index_ > 1) {
        auto const skipped = static_cast<std::uint64_t>(sample.index - last_index_ - 1);
        counters_.from_missing += skipped;
        counters_.to_missing += skipped;
    }
    started_ = true;
    last_index_ = sample.index;
    ++counters_.samples;
    output_.index = sample.index;
    output_.evaluated = false;

    BlockReasons const lacking = unusable(sample);
    std::int64_t const missing = has_good_ ? sample.index - last_good_index_ - 1 : 0;
    if (has_good_ && (missing + (lacking != 0 ? 1 : 0) > params_.max_interpolated ||
                      (lacking & (kSynchReasons | kTestReasons)) != 0)) {
        empty_window(sample.index);
    }
    if (lacking == 0) {
        Pair const pair = into_line(sample);
        if (has_good_ && missing > 0) {
            bridge(pair, missing);
        }
        element_.push(pair.from, pair.to);
        last_good_ = pair;
        last_good_index_ = sample.index;
        has_good_ = true;
    }
    BlockReasons reasons = lacking;
    reasons |= element_.full() ? 0U : static_cast<BlockReasons>(kFilling);
    reasons |= params_.in_service ? 0U : static_cast<BlockReasons>(kOutOfService);
    if (reasons != 0 &&
        reasons == lacking) { // the window is full: what it says holds until the gap is bridged or too long
        output_.blocked = reasons;
        return output_;
    }
    set_blocked(sample.index, reasons);
    if (reasons == 0) {
        decide(sample.index, permission);
    }
    return output_;
}

RelayOutput const& LineRelay::lost(BlockReasons ends) {
    output_.evaluated = false;
    set_blocked(last_index_, output_.blocked | ends);
    return output_;
}

BlockReasons LineRelay::unusable(LineSample const& sample) {
    static_assert(kToLost == kFromLost << 1U && kToQuality == kFromQuality << 1U && kToTest == kFromTest << 1U &&
                  kToSynch == kFromSynch << 1U);
    BlockReasons const from = wrong_with(sample.from, params_), to = wrong_with(sample.to, params_);
    counters_.from_missing += from == kFromLost ? 1U : 0U;
    counters_.to_missing += to == kFromLost ? 1U : 0U;
    counters_.unusable += ((from | to) & ~static_cast<BlockReasons>(kFromLost)) != 0 ? 1U : 0U;
    return from | (to << 1U);
}

LineRelay::Pair LineRelay::into_line(LineSample const& sample) const {
    Pair pair{sample.from.i_a, sample.to.i_a};
    if (params_.to_positive == Positive::from_to) { // along the line is out of it at the far end
        for (double& i : pair.to) {
            i = -i;
        }
    }
    return pair;
}

void LineRelay::bridge(Pair const& next, std::int64_t missing) {
    for (std::int64_t k = 1; k <= missing; ++k) {
        double const share = static_cast<double>(k) / static_cast<double>(missing + 1);
        Pair between;
        for (std::size_t p = 0; p < 3; ++p) {
            between.from[p] = last_good_.from[p] + share * (next.from[p] - last_good_.from[p]);
            between.to[p] = last_good_.to[p] + share * (next.to[p] - last_good_.to[p]);
        }
        element_.push(between.from, between.to);
        ++counters_.interpolated;
    }
}

void LineRelay::empty_window(std::int64_t index) {
    has_good_ = false;
    element_.clear();
    ++counters_.windows_emptied;
    note(index, RelayEvent::Kind::window_emptied);
}

void LineRelay::set_blocked(std::int64_t index, BlockReasons reasons) {
    if (reasons == output_.blocked && (reasons & ~said_) == 0) {
        return;
    }
    output_.blocked = reasons;
    bool const first = said_ == 0;
    if (reasons == 0) {
        if (!first) { // a bridged gap was not reported
            said_ = 0;
            note(index, RelayEvent::Kind::unblock);
        }
        return;
    }
    if (output_.pickup) {
        output_.pickup = false;
        note(index, RelayEvent::Kind::dropout);
    }
    confirmed_ = 0;
    output_.withheld = false;
    output_.trip = output_.trip && params_.seal_in;
    // Each reason once until the relay works again: one that comes and goes with every other sample must not fill the
    // log. Who switches the relay off and on wants to read it each time.
    BlockReasons const fresh = reasons & ~said_;
    said_ = (said_ & ~static_cast<BlockReasons>(kOutOfService)) | reasons;
    if (fresh != 0 && (first || fresh != kFilling)) {
        note(index, RelayEvent::Kind::block, reasons);
    }
}

void LineRelay::decide(std::int64_t index, TripPermission permission) {
    output_.values = element_.evaluate();
    output_.evaluated = true;
    bool const pickup = output_.values.pickup_phases != 0;
    if (pickup != output_.pickup) {
        output_.pickup = pickup;
        counters_.pickups += pickup ? 1U : 0U;
        note(index, pickup ? RelayEvent::Kind::pickup : RelayEvent::Kind::dropout);
    }
    confirmed_ = pickup ? std::min(confirmed_ + 1, params_.confirm_samples) : 0;
    bool const operate = pickup && confirmed_ >= params_.confirm_samples;
    bool const withheld = operate && !permission.granted && !output_.trip;
    if (withheld != output_.withheld) {
        output_.withheld = withheld;
        if (withheld) {
            note(index, RelayEvent::Kind::withheld);
        } else if (operate) {
            note(index, RelayEvent::Kind::released);
        }
    }
    if (operate && permission.granted && !output_.trip) {
        output_.trip = true;
        ++counters_.trips;
        note(index, RelayEvent::Kind::trip);
    } else if (!pickup && !params_.seal_in) {
        output_.trip = false;
    }
}

bool LineRelay::reset() {
    if (output_.pickup) {
        return false;
    }
    if (output_.trip) {
        output_.trip = false;
        note(last_index_, RelayEvent::Kind::reset);
    }
    return true;
}

void LineRelay::restart() {
    if (has_good_) {
        empty_window(last_index_);
    }
    started_ = false;
    set_blocked(last_index_, output_.blocked | kFilling);
}

void LineRelay::note(std::int64_t index, RelayEvent::Kind kind, BlockReasons reasons) {
    events_.push({index, kind, output_.values.pickup_phases, reasons, output_.values.differential_a});
}

} // namespace gridspace::relay

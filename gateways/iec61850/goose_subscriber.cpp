// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/goose_subscriber.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace gridspace::iec61850 {
namespace {

constexpr std::array<std::string_view, kGooseEvents> kGooseEventNames{"not_ours",
                                                                      "first",
                                                                      "state_change",
                                                                      "repetition",
                                                                      "resumed",
                                                                      "restart",
                                                                      "duplicate",
                                                                      "out_of_order",
                                                                      "stale",
                                                                      "unconfirmed_jump",
                                                                      "identity_mismatch",
                                                                      "conf_rev_mismatch",
                                                                      "needs_commissioning",
                                                                      "data_set_mismatch",
                                                                      "inconsistent",
                                                                      "simulation_refused",
                                                                      "no_time_to_live"};

void collect_shape(std::vector<DataNode> const& members, std::uint8_t depth, std::vector<std::uint32_t>& tags,
                   std::vector<std::uint8_t>& depths) {
    for (DataNode const& member : members) {
        depths.push_back(depth);
        if (member.kind == DataNode::Kind::leaf) {
            tags.push_back(0);
        } else {
            tags.push_back(member.kind == DataNode::Kind::structure ? data_tag::kStructure : data_tag::kArray);
            collect_shape(member.members, static_cast<std::uint8_t>(depth + 1), tags, depths);
        }
    }
}

bool is_time(BasicType type) noexcept {
    return type == BasicType::timestamp || type == BasicType::entry_time;
}

GooseVerdict refuse(GooseEvent event) noexcept {
    return {event, false, false, 0, 0};
}

} // namespace

std::string_view event_name(GooseEvent event) noexcept {
    return kGooseEventNames[static_cast<std::size_t>(event)];
}

GooseSubscriber::GooseSubscriber(GooseSubscription subscription)
    : subscription_{std::move(subscription)}, leaves_{leaves_of(subscription_.data_set)}, values_(leaves_.size()),
      texts_(leaves_.size()) {
    collect_shape(subscription_.data_set.members, 0, container_tags_, depths_);
    subscription_.fail_safe.resize(leaves_.size());
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
        values_[i].type = leaves_[i].type;
        values_[i].bit_count =
            static_cast<std::uint8_t>(leaves_[i].type == BasicType::bit_string ? leaves_[i].length : 0);
        if (is_string(leaves_[i].type)) {
            texts_[i].reserve(kMaxLength); // the longest that a frame can bring: no allocation later
        }
    }
}

std::optional<std::size_t> GooseSubscriber::index_of(std::string_view leaf) const noexcept {
    auto const found = std::find_if(leaves_.begin(), leaves_.end(), [&](Leaf const& l) { return l.name == leaf; });
    if (found == leaves_.end()) {
        return std::nullopt;
    }
    return static_cast<std::size_t>(found - leaves_.begin());
}

Value GooseSubscriber::value(std::size_t leaf) const noexcept {
    FailSafe const& safe = subscription_.fail_safe[leaf];
    if (status_ != GooseStatus::good && safe.force && safe.value.type == leaves_[leaf].type) {
        return safe.value;
    }
    Value out = values_[leaf];
    out.text = texts_[leaf];
    return out;
}

void GooseSubscriber::set_simulation(bool simulation) noexcept {
    subscription_.simulation = simulation;
    seen_simulated_ = false;
}

std::optional<GooseEvent> GooseSubscriber::reason_to_refuse(GooseFrame const& m) noexcept {
    GooseSubscription const& s = subscription_;
    if ((s.destination && m.header.destination != *s.destination) || (s.source && m.header.source != *s.source) ||
        (s.app_id && m.header.app_id != *s.app_id) || (!s.dat_set.empty() && m.dat_set != s.dat_set) ||
        (!s.go_id.empty() && m.has(GooseFrame::go_id_field) && m.go_id != s.go_id)) {
        return GooseEvent::identity_mismatch;
    }
    if (m.live_ms == 0) {
        return GooseEvent::no_time_to_live;
    }
    if (m.nds_com) {
        return GooseEvent::needs_commissioning;
    }
    if (m.conf_rev != s.conf_rev) {
        return GooseEvent::conf_rev_mismatch;
    }
    if (m.simulated() != s.simulation && (m.simulated() || seen_simulated_)) {
        return GooseEvent::simulation_refused;
    }
    if (m.declared_entries != m.entries || m.entries != s.data_set.members.size()) {
        return GooseEvent::data_set_mismatch;
    }
    return std::nullopt;
}

GooseSubscriber::Match GooseSubscriber::match(GooseFrame const& message, bool store) noexcept {
    DataWalker walker{message.all_data, message.all_data_offset};
    Tlv element;
    std::size_t node = 0, leaf = 0;
    bool different = false;
    while (walker.next(element)) {
        if (node == container_tags_.size() || walker.depth() != depths_[node]) {
            return Match::mismatch;
        }
        std::uint32_t const container = container_tags_[node++];
        if (container != 0) {
            if (element.tag != container) {
                return Match::mismatch;
            }
            continue;
        }
        auto const value = is_container(element.tag) ? std::nullopt : read_data_value(element, leaves_[leaf].type);
        if (!value) {
            return Match::mismatch;
        }
        bool const same = value->bits == values_[leaf].bits && std::ranges::equal(value->text, texts_[leaf]);
        different = different || (!same && !is_time(value->type));
        if (store && !same) {
            values_[leaf].bits = value->bits;
            values_[leaf].bit_count = value->bit_count;
            texts_[leaf].assign(value->text.begin(), value->text.end());
        }
        ++leaf;
    }
    if (node != container_tags_.size()) {
        return Match::mismatch;
    }
    return different ? Match::different : Match::same;
}

GooseVerdict GooseSubscriber::judge_older(GooseFrame const& m) const noexcept {
    if (subscription_.strict) {
        return refuse(GooseEvent::stale);
    }
    // A state that began before the one we hold is a message that was overtaken, or a replay. A publisher that was
    // restarted stamps its state later (or not at all: 0 on both sides); one whose clock went back is heard again after
    // the loss. One that has no clock yet says so; that it counts from 1 again is then all it can tell. (With 2 held,
    // stNum 1 may as well be the state before, overtaken.)
    constexpr std::uint8_t kNoClock = UtcTime::kClockFailure | UtcTime::kNotSynchronised;
    if ((m.t.quality & kNoClock) != 0 && m.st_num == 1 && st_num_ > 2) {
        return {GooseEvent::restart, true, true, 0, 0};
    }
    if (m.t.bits() >> 8U < t_.bits() >> 8U) {
        return refuse(GooseEvent::out_of_order);
    }
    return {GooseEvent::restart, true, true, 0, 0};
}

/// A counter may claim four thousand million lost messages. No more can be, since the stream has not expired, than its
/// publisher sends in the time that it promised: at most one in a millisecond.
std::uint32_t GooseSubscriber::missed(std::uint32_t claimed) const noexcept {
    return std::min(claimed, live_ms_);
}

GooseVerdict GooseSubscriber::judge_counters(GooseFrame const& m, std::int64_t utc_ns) noexcept {
    bool const skewed = subscription_.strict && subscription_.max_skew_ns > 0 && m.st_num != st_num_ &&
                        std::llabs(utc_ns - m.t.nanoseconds()) > subscription_.max_skew_ns;
    if (status_ != GooseStatus::good) {
        bool const initial = status_ == GooseStatus::waiting;
        return {initial ? GooseEvent::first : GooseEvent::resumed, true, true, 0, 0};
    }
    if (m.st_num == st_num_) {
        unconfirmed_st_num_.reset();
        bool const rolled_over = sq_num_ == std::numeric_limits<std::uint32_t>::max() && m.sq_num == 1;
        // t is when stNum was counted up: a later one with a counter that went back is another state, of a publisher
        // that was restarted and counts from the same number.
        if (!subscription_.strict && m.sq_num <= sq_num_ && !rolled_over && m.t.bits() >> 8U > t_.bits() >> 8U) {
            return {GooseEvent::restart, true, true, 0, 0};
        }
        if (m.sq_num == sq_num_) {
            return refuse(GooseEvent::duplicate);
        }
        if (m.sq_num < sq_num_ && !rolled_over) {
            return refuse(GooseEvent::out_of_order);
        }
        if (match(m, false) == Match::different) {
            return refuse(GooseEvent::inconsistent);
        }
        return {GooseEvent::repetition, true, false, rolled_over ? 0 : missed(m.sq_num - sq_num_ - 1), 0};
    }
    bool const rolled_over = st_num_ == std::numeric_limits<std::uint32_t>::max() && m.st_num == 1;
    if (m.st_num < st_num_ && !rolled_over) {
        return judge_older(m);
    }
    if (skewed) {
        return refuse(GooseEvent::stale);
    }
    std::uint32_t const skipped = rolled_over ? 0 : m.st_num - st_num_ - 1;
    if (subscription_.strict && skipped > 0 && unconfirmed_st_num_ != m.st_num) {
        unconfirmed_st_num_ = m.st_num; // one frame alone must not set the mark that all later ones are measured by
        return refuse(GooseEvent::unconfirmed_jump);
    }
    return {GooseEvent::state_change, true, true, missed(m.sq_num), missed(skipped)};
}

GooseVerdict GooseSubscriber::receive(GooseFrame const& m, std::int64_t now_ns, std::int64_t utc_ns,
                                      bool whatever_counters) noexcept {
    GooseVerdict verdict;
    if (m.gocb_ref != subscription_.gocb_ref) {
        return verdict;
    }
    if (deadline_ns_ && now_ns > *deadline_ns_) { // whoever looked first; one that comes just in time goes on
        expire(now_ns);
    }
    if (auto const refused = reason_to_refuse(m)) {
        verdict = refuse(*refused);
    } else if (match(m, false) == Match::mismatch) {
        verdict = refuse(GooseEvent::data_set_mismatch);
    } else {
        verdict = whatever_counters ? GooseVerdict{GooseEvent::restart, true, true, 0, 0} : judge_counters(m, utc_ns);
    }
    ++counters_.events[static_cast<std::size_t>(verdict.event)];
    if (!verdict.accepted) {
        return verdict;
    }
    (void)match(m, true);
    arrivals_.add(taken_++, now_ns);
    counters_.lost += verdict.lost;
    counters_.skipped_states += verdict.skipped_states;
    seen_simulated_ = seen_simulated_ || m.simulated();
    unconfirmed_st_num_.reset();
    st_num_ = m.st_num;
    sq_num_ = m.sq_num;
    t_ = m.t;
    live_ms_ = m.live_ms;
    status_ = GooseStatus::good;
    deadline_ns_ = now_ns + std::int64_t{m.live_ms} * 1'000'000;
    return verdict;
}

bool GooseSubscriber::expire(std::int64_t now_ns) noexcept {
    if (!deadline_ns_ || now_ns < *deadline_ns_) {
        return false;
    }
    deadline_ns_.reset();
    status_ = GooseStatus::expired;
    ++counters_.expired;
    return true;
}

} // namespace gridspace::iec61850

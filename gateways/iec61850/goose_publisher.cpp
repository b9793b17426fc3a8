// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/goose_publisher.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gridspace::iec61850 {
namespace {

/// Counters roll over to 1: 0 is for the first message of a state (sqNum) or never sent (stNum).
std::uint32_t successor(std::uint32_t counter) noexcept {
    return counter == std::numeric_limits<std::uint32_t>::max() ? 1 : counter + 1;
}

/// A new one alone makes no new state: a device stamps with every scan.
bool is_stamp(BasicType type) noexcept {
    return type == BasicType::timestamp || type == BasicType::entry_time;
}

} // namespace

GoosePublisher::GoosePublisher(GooseTemplate frame, std::uint32_t conf_rev, GoosePublisherParams const& params)
    : frame_{std::move(frame)}, params_{params} {
    params_.timing.min_ns = std::max<std::int64_t>(params_.timing.min_ns, 1);
    params_.timing.max_ns = std::max(params_.timing.max_ns, params_.timing.min_ns);
    params_.timing.growth = std::max(params_.timing.growth, 1.0);
    state_.st_num = std::max(params.first_st_num, 1U);
    state_.simulation = params.simulation;
    state_.nds_com = conf_rev == 0; // the control block needs commissioning
    kept_.resize(frame_.leaves().size());
    for (std::size_t i = 0; i < kept_.size(); ++i) {
        kept_[i].text.reserve(is_string(frame_.leaves()[i].type) ? frame_.leaves()[i].length : 0);
    }
}

void GoosePublisher::start(std::int64_t now_ns, std::int64_t utc_ns) {
    keep_values();
    begin_state(now_ns, utc_ns);
    state_.sq_num = params_.first_sq_num;
}

bool GoosePublisher::keep_values() noexcept {
    bool differs = false;
    for (std::size_t i = 0; i < kept_.size(); ++i) {
        Value const value = frame_.get(i);
        if (is_stamp(value.type)) {
            continue;
        }
        std::string_view const text{reinterpret_cast<char const*>(value.text.data()), value.text.size()};
        if (kept_[i].bits != value.bits || kept_[i].text != text) {
            kept_[i].bits = value.bits;
            kept_[i].text.assign(text); // of its own memory: reserved for the longest
            differs = true;
        }
    }
    return differs;
}

void GoosePublisher::begin_state(std::int64_t now_ns, std::int64_t utc_ns) noexcept {
    state_.sq_num = 0;
    state_.t = UtcTime::from_nanoseconds(utc_ns, params_.time_quality);
    interval_ns_ = params_.timing.min_ns;
    due_ns_ = now_ns;
    first_of_state_ = true;
    staged_ = false;
    ++counters_.states;
}

GooseTemplate::Stored GoosePublisher::set(std::size_t leaf, Value const& value) noexcept {
    auto const stored = frame_.set(leaf, value);
    if (stored == GooseTemplate::Stored::refused) {
        ++counters_.refused;
    } else if (stored == GooseTemplate::Stored::changed && !is_stamp(value.type)) {
        staged_ = true;
    }
    return stored;
}

bool GoosePublisher::commit(std::int64_t now_ns, std::int64_t utc_ns) noexcept {
    if (!staged_ || !due_ns_) {
        return false;
    }
    if (!keep_values()) {
        staged_ = false;
        return false;
    }
    state_.st_num = successor(state_.st_num);
    begin_state(now_ns, utc_ns);
    return true;
}

std::uint32_t GoosePublisher::live_ms() const noexcept {
    double const wanted = std::ceil(params_.timing.live_factor * static_cast<double>(interval_ns_) * 1e-6);
    // The next message must come within the time: never less than the interval itself, in whole milliseconds.
    double const least = static_cast<double>(interval_ns_ / 1'000'000 + 1);
    return static_cast<std::uint32_t>(
        std::clamp(std::max({wanted, least, static_cast<double>(params_.timing.live_min_ms)}), 1.0, 4294967295.0));
}

Octets GoosePublisher::emit() noexcept {
    if (!first_of_state_) {
        state_.sq_num = successor(state_.sq_num);
    }
    first_of_state_ = false;
    state_.live_ms = live_ms();
    ++counters_.sent;
    return frame_.frame(state_);
}

Octets GoosePublisher::take(std::int64_t now_ns) noexcept {
    if (!due_ns_ || now_ns < *due_ns_) {
        return {};
    }
    Octets const message = emit();
    // From when it was due, not from now: lateness does not add up. After a stall the missed ones are not sent in a
    // burst.
    *due_ns_ += interval_ns_;
    if (*due_ns_ <= now_ns) {
        *due_ns_ = now_ns + interval_ns_;
        ++counters_.late;
    }
    double const grown = static_cast<double>(interval_ns_) * params_.timing.growth;
    interval_ns_ = grown >= static_cast<double>(params_.timing.max_ns) ? params_.timing.max_ns
                                                                       : static_cast<std::int64_t>(std::llround(grown));
    return message;
}

Octets GoosePublisher::last(std::int64_t now_ns) noexcept {
    if (!due_ns_) {
        return {};
    }
    due_ns_ = now_ns;
    return take(now_ns);
}

} // namespace gridspace::iec61850

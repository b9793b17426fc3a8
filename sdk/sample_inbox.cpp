// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sdk/sample_inbox.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>

namespace gridspace::sdk {

void SampleInbox::take(int reader, std::vector<Arrival>& arrivals) {
    std::lock_guard const lock{mutex_};
    auto const later =
        std::partition(waiting_.begin(), waiting_.end(), [&](Arrival const& a) { return a.origin.time <= until_; });
    for (auto arrival = waiting_.begin(); arrival != later; ++arrival) {
        arrival->reader = reader;
        arrivals.push_back(std::move(*arrival));
    }
    waiting_.erase(waiting_.begin(), later);
}

bool SampleInbox::push(std::span<std::byte const> cdr, bus::Origin origin, TimeBase const& base) {
    SampleBlock* const block = SampleBlock::decode(type_->layout(), cdr);
    if (block == nullptr) {
        return false;
    }
    KeptSample sample{block};
    if (!filter_.admits(sample.get())) {
        return true;
    }
    if (auto const offset = type_->time_offset()) {
        std::int64_t time_ns = 0;
        std::memcpy(&time_ns, static_cast<std::byte const*>(sample.get()) + *offset, sizeof time_ns);
        origin.time = base.from_nanoseconds(time_ns);
    }
    std::lock_guard const lock{mutex_};
    waiting_.push_back({origin, 0, std::move(sample)});
    return true;
}

bool SampleInbox::has_due(SimTime until) const {
    std::lock_guard const lock{mutex_};
    return std::any_of(waiting_.begin(), waiting_.end(), [&](Arrival const& a) { return a.origin.time <= until; });
}

} // namespace gridspace::sdk

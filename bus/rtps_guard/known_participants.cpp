// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/rtps_guard/known_participants.hpp"

namespace gridspace::rtps_guard {

bool KnownParticipants::hear(GuidPrefix const& prefix, std::int64_t now_ns) {
    auto const it = heard_ns_.find(prefix);
    if (it == heard_ns_.end()) {
        return false;
    }
    it->second = now_ns;
    return true;
}

bool KnownParticipants::announce(GuidPrefix const& prefix, std::int64_t now_ns) {
    constexpr std::int64_t kLookEveryNs = 1'000'000'000; // under a flood not for each of it
    if (hear(prefix, now_ns)) {
        return true;
    }
    if (heard_ns_.size() >= most_ && (looked_ns_ == INT64_MIN || now_ns - looked_ns_ >= kLookEveryNs)) {
        looked_ns_ = now_ns;
        std::erase_if(heard_ns_, [&](auto const& entry) { return now_ns - entry.second > kForgottenAfterNs; });
    }
    if (heard_ns_.size() >= most_) {
        return false;
    }
    heard_ns_.emplace(prefix, now_ns);
    return true;
}

} // namespace gridspace::rtps_guard

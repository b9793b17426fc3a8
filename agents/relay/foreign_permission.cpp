// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/foreign_permission.hpp"

#include <algorithm>

namespace gridspace::relay {

void ForeignPermission::verdict(std::size_t end, std::int64_t index, bool flagged) {
    judged_[end] = std::max(judged_[end], index);
    if (flagged) {
        flagged_[end] = std::max(flagged_[end], index);
    }
}

ForeignPermission::Reason ForeignPermission::judge(std::int64_t index) const {
    if (std::max(flagged_[0], flagged_[1]) >= since_ - params_.hold) { // for as long as the pickup lasts
        bool const long_enough = params_.trips_at_last && index - since_ >= params_.delay;
        return long_enough ? Reason::timed_out : Reason::flagged;
    }
    if (std::min(judged_[0], judged_[1]) >= since_) {
        return Reason::genuine;
    }
    return index - since_ >= params_.wait ? Reason::unheard : Reason::waiting;
}

bool ForeignPermission::step(std::int64_t index, bool picked_up) {
    if (picked_up && !picked_up_) {
        since_ = index - 1; // it picked up at the sample before
    }
    picked_up_ = picked_up;
    reason_ = picked_up ? judge(index) : Reason::none;
    granted_ = reason_ == Reason::genuine || reason_ == Reason::timed_out ||
               (reason_ == Reason::unheard && params_.trips_unheard);
    return granted_;
}

char const* to_string(ForeignPermission::Reason reason) {
    using Reason = ForeignPermission::Reason;
    switch (reason) {
    case Reason::none:
        return "no pickup";
    case Reason::waiting:
        return "waits for the verdict";
    case Reason::genuine:
        return "the detector finds nothing";
    case Reason::flagged:
        return "the detector flags the samples";
    case Reason::timed_out:
        return "flagged, and the pickup lasts";
    case Reason::unheard:
        return "the detector has said nothing";
    }
    return "";
}

} // namespace gridspace::relay

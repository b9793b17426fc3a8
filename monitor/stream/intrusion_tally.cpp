// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/stream/intrusion_tally.hpp"

#include <bit>
#include <cmath>
#include <limits>

namespace gridspace::stream {
namespace {

double percent(std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? std::numeric_limits<double>::quiet_NaN()
                      : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

} // namespace

double IntrusionTally::Counts::false_positive_percent() const {
    return percent(flagged - forged_flagged, judged - forged_judged);
}

double IntrusionTally::Counts::open_loop_false_positive_percent() const {
    return percent(open_flagged - forged_open_flagged, judged - forged_judged);
}

double IntrusionTally::Counts::detected_percent() const {
    return percent(detected, fakes - unscored);
}

void IntrusionTally::verdict(std::uint64_t index, bool judged, std::uint8_t flagged, bool open_flagged) {
    if (judged_.empty()) {
        judged_.resize(kSamples);
    }
    Judged& place = judged_[index % kSamples];
    if (place.index == index) {
        return; // it came twice
    }
    place = {index, judged, open_flagged, flagged};
    if (!judged) {
        return;
    }
    ++counts_.judged;
    counts_.flagged += flagged != 0 ? 1 : 0;
    counts_.open_flagged += open_flagged ? 1 : 0;
    if (auto const it = forged_.find(index); it != forged_.end()) {
        ++counts_.forged_judged;
        counts_.forged_flagged += flagged != 0 ? 1 : 0;
        counts_.forged_open_flagged += open_flagged ? 1 : 0;
        auto const phases = static_cast<std::uint64_t>(std::popcount(it->second));
        counts_.detected += static_cast<std::uint64_t>(std::popcount(static_cast<std::uint8_t>(it->second & flagged)));
        counts_.unscored -= phases;
    }
}

void IntrusionTally::label(std::uint64_t index, std::uint8_t phase) {
    auto const bit = static_cast<std::uint8_t>(1U << (phase & 7U));
    auto const [it, fresh] = forged_.size() < kLabels || forged_.contains(index)
                                 ? forged_.try_emplace(index, std::uint8_t{0})
                                 : std::pair{forged_.end(), false};
    if (it != forged_.end() && (it->second & bit) != 0) {
        return; // it came twice
    }
    if (it != forged_.end()) {
        it->second = static_cast<std::uint8_t>(it->second | bit);
    }
    ++counts_.fakes;
    Judged const* const place = judged_.empty() ? nullptr : &judged_[index % kSamples];
    if (place == nullptr || place->index != index || !place->judged) {
        ++counts_.unscored;
        return;
    }
    if (fresh) {
        ++counts_.forged_judged;
        counts_.forged_flagged += place->flagged != 0 ? 1 : 0;
        counts_.forged_open_flagged += place->open_flagged ? 1 : 0;
    }
    counts_.detected += (place->flagged & bit) != 0 ? 1 : 0;
}

} // namespace gridspace::stream

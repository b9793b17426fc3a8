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

std::uint64_t ones(unsigned bits) {
    return static_cast<std::uint64_t>(std::popcount(bits));
}

} // namespace

double IntrusionTally::Counts::false_positive_percent() const {
    return percent(false_positives(), judged - forged_judged);
}

double IntrusionTally::Counts::open_loop_false_positive_percent() const {
    return percent(open_flagged - forged_open_flagged, judged - forged_judged);
}

double IntrusionTally::Counts::detected_percent() const {
    return percent(detected, forged_judged);
}

void IntrusionTally::verdict(std::uint64_t index, Phases said) {
    if (judged_.empty()) {
        judged_.resize(kSamples);
    }
    Judged& place = judged_[index % kSamples];
    if (place.index == index) {
        return; // it came twice
    }
    said.flagged &= said.judged;
    said.open_flagged &= said.judged;
    place = {index, said};
    counts_.judged += ones(said.judged);
    counts_.flagged += ones(said.flagged);
    counts_.open_flagged += ones(said.open_flagged);
    if (auto const it = forged_.find(index); it != forged_.end()) {
        count_forged(it->second, said);
    }
}

void IntrusionTally::label(std::uint64_t index, std::uint8_t phase) {
    auto const bit = static_cast<std::uint8_t>(1U << (phase & 7U));
    if (forged_.size() < kLabels || forged_.contains(index)) {
        std::uint8_t& phases = forged_[index];
        if ((phases & bit) != 0) {
            return; // it came twice
        }
        phases |= bit;
    }
    ++counts_.fakes;
    if (!judged_.empty() && judged_[index % kSamples].index == index) {
        count_forged(bit, judged_[index % kSamples].said);
    }
}

void IntrusionTally::count_forged(std::uint8_t phases, Phases const& said) {
    counts_.forged_judged += ones(phases & said.judged);
    counts_.detected += ones(phases & said.flagged);
    counts_.forged_open_flagged += ones(phases & said.open_flagged);
}

} // namespace gridspace::stream

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/wire/steady_interval.hpp"

#include <algorithm>
#include <vector>

namespace gridspace::wire {
namespace {

/// Publishers grow by a factor of 1.5 or 2; less than this is jitter, of an interval that stays.
constexpr double kSame = 1.25;

bool same(double a, double b) {
    return a <= b * kSame && b <= a * kSame;
}

} // namespace

std::optional<double> steady_interval_ms(std::span<MessageInterval const> intervals) {
    std::vector<double> steady;
    for (std::size_t i = 1; i < intervals.size(); ++i) {
        // Of one state, like the one before, and not like that only because MinTime is used twice.
        bool const stays =
            intervals[i].same_state && intervals[i - 1].same_state && same(intervals[i].ms, intervals[i - 1].ms);
        bool const grows_again =
            i + 1 < intervals.size() && intervals[i + 1].same_state && intervals[i + 1].ms > intervals[i].ms * kSame;
        if (stays && !grows_again) {
            steady.push_back(intervals[i].ms);
        }
    }
    if (steady.empty()) {
        return std::nullopt;
    }
    // A burst that was broken off where it repeats its shortest interval is no steady state.
    double const longest = *std::max_element(steady.begin(), steady.end());
    std::erase_if(steady, [&](double ms) { return ms * kSame < longest; });
    std::sort(steady.begin(), steady.end());
    return steady[(steady.size() - 1) / 2];
}

} // namespace gridspace::wire

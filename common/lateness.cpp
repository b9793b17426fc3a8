// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/lateness.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace gridspace {

/// Below kParts each nanosecond is a class; above, the three bits after the leading one give the part of the octave.
std::size_t Lateness::class_of(std::uint64_t ns) {
    if (ns < kParts) {
        return static_cast<std::size_t>(ns);
    }
    auto const octave = static_cast<std::size_t>(std::bit_width(ns)) - 4; // 0: from 8 to 15
    return (octave + 1) * kParts + static_cast<std::size_t>((ns >> octave) - kParts);
}

void Lateness::add(std::chrono::nanoseconds late) {
    late = std::max(late, std::chrono::nanoseconds{0});
    ++instants_;
    later_than_a_period_ += late > period_ ? 1 : 0;
    worst_ = std::max(worst_, late);
    ++counts_[class_of(static_cast<std::uint64_t>(late.count()))];
}

double Lateness::percentile_us(double share) const {
    auto const rank = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(instants_)));
    std::uint64_t counted = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
        counted += counts_[i];
        if (counted >= rank && counted > 0) {
            std::size_t const octave = i < kParts ? 0 : i / kParts - 1;
            double const end = i < kParts
                                   ? static_cast<double>(i)
                                   : std::ldexp(static_cast<double>(i % kParts + kParts + 1), static_cast<int>(octave));
            return std::min(end, static_cast<double>(worst_.count())) / 1e3;
        }
    }
    return 0;
}

Lateness::Summary Lateness::summary() const {
    return {static_cast<double>(period_.count()) / 1e3,
            instants_,
            later_than_a_period_,
            percentile_us(0.5),
            percentile_us(0.99),
            percentile_us(0.999),
            static_cast<double>(worst_.count()) / 1e3};
}

} // namespace gridspace

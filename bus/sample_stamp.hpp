// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace gridspace::bus {

/// Time stamps of DDS end in 2038: their seconds have 31 bits (DDSI-RTPS 2.2, 9.3.2; Fast DDS refuses others). Those of
/// later times start again at 0 after this.
inline constexpr std::int64_t kStampPeriodNs = 2'147'483'647LL * 1'000'000'000;

/// The stamp of an instant, in nanoseconds since 1970.
[[nodiscard]] constexpr std::int64_t stamp_of(std::int64_t ns) {
    std::int64_t const rest = ns % kStampPeriodNs;
    return rest < 0 ? rest + kStampPeriodNs : rest;
}

/// How long after `from_ns` the instant is that has this stamp (or is given itself); of all that could be meant, the
/// nearest: up to 34 years.
[[nodiscard]] constexpr std::int64_t stamp_after(std::int64_t stamp_ns, std::int64_t from_ns) {
    std::int64_t const ahead = stamp_of(stamp_ns - from_ns);
    return ahead < kStampPeriodNs / 2 ? ahead : ahead - kStampPeriodNs;
}

} // namespace gridspace::bus

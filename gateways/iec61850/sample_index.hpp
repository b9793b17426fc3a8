// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

namespace gridspace::iec61850 {

/// The index of a sample since time 0 from its counter, which begins anew each second, and about when it was seen (half
/// a second either way).
[[nodiscard]] inline std::int64_t absolute_index(std::uint16_t smp_cnt, double rate_hz, std::int64_t time_ns) {
    double const in_second_s = static_cast<double>(smp_cnt) / rate_hz;
    return std::llround((std::round(static_cast<double>(time_ns) / 1e9 - in_second_s) + in_second_s) * rate_hz);
}

} // namespace gridspace::iec61850

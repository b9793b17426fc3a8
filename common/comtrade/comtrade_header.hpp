// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace {

enum class ComtradeFormat { ascii, binary, float32 };

struct ComtradeChannel {
    std::string name, phase, unit;
    std::string circuit{};           ///< the element that is watched
    double a{1}, b{0};               ///< value = a * what is stored + b
    double low{0}, high{0};          ///< of what is stored
    bool normally_set{false};        ///< digital: its state out of disturbances
    double primary{1}, secondary{1}; ///< ratio of the instrument transformer; values are primary ones
};

struct ComtradeHeader {
    std::string station{"gridspace"}, device{"simulation"};
    std::vector<ComtradeChannel> analog, digital;
    double line_frequency_hz{60};
    double sample_rate_hz{0};
    std::int64_t start_unix_ns{0};   ///< UTC of the first sample
    std::int64_t trigger_unix_ns{0}; ///< UTC of what the record is about
};

/// The text of a .cfg, IEEE C37.111-2013 (IEC 60255-24): primary values, times in UTC from a locked clock.
[[nodiscard]] std::string comtrade_cfg(ComtradeHeader const& header, ComtradeFormat format, std::size_t rows);

/// Microseconds from the first sample to sample `row`: the time stamp of the .dat.
[[nodiscard]] std::uint32_t comtrade_stamp_us(ComtradeHeader const& header, std::size_t row);

} // namespace gridspace

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/comtrade/comtrade_header.hpp"

#include "common/text.hpp"
#include "common/time.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace {
namespace {

/// Commas separate the fields of the .cfg.
std::string field(std::string text) {
    for (char& c : text) {
        c = c == ',' || c == '\n' || c == '\r' ? '_' : c;
    }
    return text;
}

/// dd/mm/yyyy,hh:mm:ss.ssssss
std::string stamp(std::int64_t unix_ns) {
    std::int64_t const half_up = unix_ns + 500; // the format has microseconds
    std::int64_t const us = half_up / 1000 - (half_up % 1000 < 0 ? 1 : 0);
    std::int64_t const seconds = us / 1'000'000 - (us % 1'000'000 < 0 ? 1 : 0);
    std::string const utc = format_utc(seconds); // yyyy-mm-ddThh:mm:ssZ
    return fmt::format("{}/{}/{},{}.{:06}", utc.substr(8, 2), utc.substr(5, 2), utc.substr(0, 4), utc.substr(11, 8),
                       us - seconds * 1'000'000);
}

std::string_view name_of(ComtradeFormat format) {
    return format == ComtradeFormat::ascii ? "ASCII" : format == ComtradeFormat::binary ? "BINARY" : "FLOAT32";
}

} // namespace

std::uint32_t comtrade_stamp_us(ComtradeHeader const& header, std::size_t row) {
    return header.sample_rate_hz > 0
               ? static_cast<std::uint32_t>(std::llround(static_cast<double>(row) / header.sample_rate_hz * 1e6))
               : 0;
}

std::string comtrade_cfg(ComtradeHeader const& header, ComtradeFormat format, std::size_t rows) {
    std::string text =
        fmt::format("{},{},2013\r\n{},{}A,{}D\r\n", field(header.station), field(header.device),
                    header.analog.size() + header.digital.size(), header.analog.size(), header.digital.size());
    int n = 0;
    for (ComtradeChannel const& c : header.analog) {
        text += fmt::format("{},{},{},{},{},{},{},0,{},{},{},{},P\r\n", ++n, field(c.name), field(c.phase),
                            field(c.circuit), field(c.unit), shortest(c.a), shortest(c.b), shortest(c.low),
                            shortest(c.high), shortest(c.primary), shortest(c.secondary));
    }
    n = 0;
    for (ComtradeChannel const& c : header.digital) {
        text += fmt::format("{},{},{},{},{}\r\n", ++n, field(c.name), field(c.phase), field(c.circuit),
                            c.normally_set ? 1 : 0);
    }
    // Last: time multiplier; UTC and UTC; clock locked, no leap second.
    return text + fmt::format("{}\r\n1\r\n{},{}\r\n{}\r\n{}\r\n{}\r\n1\r\n0,0\r\n0,0\r\n",
                              shortest(header.line_frequency_hz), shortest(header.sample_rate_hz), rows,
                              stamp(header.start_unix_ns), stamp(header.trigger_unix_ns), name_of(format));
}

} // namespace gridspace

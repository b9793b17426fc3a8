// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/comtrade/comtrade_record.hpp"

#include "common/comtrade/little_endian.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <fstream>

namespace gridspace {
namespace {

constexpr int kAsciiMissing = 99999; // C37.111-1999; a reader of 2013 sees that it is outside of min and max
constexpr std::uint32_t kBinaryMissing = 0x8000;
constexpr char kEndOfFile = '\x1a'; // required behind the last row in ASCII

/// The largest stored magnitude.
double full_scale(ComtradeFormat format) {
    return format == ComtradeFormat::ascii ? 99998 : format == ComtradeFormat::binary ? 32767 : 3.4028235e38;
}

void scale(ComtradeChannel& channel, std::vector<double> const& values, ComtradeFormat format) {
    channel.high = full_scale(format);
    channel.low = -channel.high;
    channel.a = 1;
    channel.b = 0;
    if (format == ComtradeFormat::float32) {
        return;
    }
    double peak = 0;
    for (double const v : values) {
        peak = std::isfinite(v) ? std::max(peak, std::fabs(v)) : peak;
    }
    if (peak > 0) {
        channel.a = peak / channel.high;
    }
}

std::string ascii_row(ComtradeRecord const& r, std::size_t row) {
    std::string out = fmt::format("{},{}", row + 1, comtrade_stamp_us(r.header, row));
    for (std::size_t i = 0; i < r.analog.size(); ++i) {
        double const v = r.analog[i][row];
        out += fmt::format(",{}",
                           std::isfinite(v) ? static_cast<int>(std::lround(v / r.header.analog[i].a)) : kAsciiMissing);
    }
    for (auto const& channel : r.digital) {
        out += channel[row] ? ",1" : ",0";
    }
    return out + "\r\n";
}

std::string binary_row(ComtradeRecord const& r, std::size_t row, bool floats) {
    std::string out;
    put(out, static_cast<std::uint32_t>(row + 1), 4);
    put(out, comtrade_stamp_us(r.header, row), 4);
    for (std::size_t i = 0; i < r.analog.size(); ++i) {
        double const v = r.analog[i][row];
        if (floats) {
            put(out, std::bit_cast<std::uint32_t>(static_cast<float>(v)), 4);
        } else {
            put(out,
                std::isfinite(v) ? static_cast<std::uint32_t>(std::lround(v / r.header.analog[i].a)) : kBinaryMissing,
                2);
        }
    }
    for (std::size_t i = 0; i < r.digital.size(); i += 16) {
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 16 && i + k < r.digital.size(); ++k) {
            word |= r.digital[i + k][row] ? 1U << k : 0U;
        }
        put(out, word, 2);
    }
    return out;
}

Result<void> write_file(std::filesystem::path const& file, std::string const& text) {
    std::error_code ignored;
    std::filesystem::remove(file, ignored); // never through a link to somewhere else
    std::ofstream stream{file, std::ios::binary | std::ios::trunc};
    stream << text;
    stream.close();
    return stream ? Result<void>{}
                  : fail(ExitCode::environment, fmt::format("cannot write '{}'", file.string()),
                         "does the folder exist, and is there space?");
}

/// The parts behind each other, each below a line that names it; those without anything are there too.
std::string single_file(std::string const& cfg, std::string const& data, ComtradeFormat format) {
    std::string const kind =
        format == ComtradeFormat::ascii
            ? "ASCII"
            : fmt::format("{}: {}", format == ComtradeFormat::binary ? "BINARY" : "FLOAT32", data.size());
    return "--- file type: CFG ---\r\n" + cfg + "--- file type: INF ---\r\n--- file type: HDR ---\r\n" +
           fmt::format("--- file type: DAT {} ---\r\n", kind) + data;
}

} // namespace

std::size_t ComtradeRecord::rows() const {
    return !analog.empty() ? analog.front().size() : !digital.empty() ? digital.front().size() : 0;
}

Result<std::filesystem::path> write_comtrade(std::filesystem::path const& base, ComtradeRecord record,
                                             ComtradeFormat format, ComtradeFiles files) {
    std::size_t const rows = record.rows();
    for (std::size_t i = 0; i < record.analog.size(); ++i) {
        scale(record.header.analog[i], record.analog[i], format);
    }
    std::string data;
    for (std::size_t row = 0; row < rows; ++row) {
        data += format == ComtradeFormat::ascii ? ascii_row(record, row)
                                                : binary_row(record, row, format == ComtradeFormat::float32);
    }
    if (format == ComtradeFormat::ascii) {
        data += kEndOfFile;
    }
    std::filesystem::path cfg = base, dat = base;
    if (files == ComtradeFiles::single) {
        cfg += ".cff";
        auto const ok = write_file(cfg, single_file(comtrade_cfg(record.header, format, rows), data, format));
        return ok ? Result<std::filesystem::path>{cfg} : std::unexpected{ok.error()};
    }
    cfg += ".cfg";
    dat += ".dat";
    if (auto ok = write_file(dat, data); !ok) {
        return std::unexpected{ok.error()};
    }
    if (auto ok = write_file(cfg, comtrade_cfg(record.header, format, rows)); !ok) {
        return std::unexpected{ok.error()};
    }
    return cfg;
}

} // namespace gridspace

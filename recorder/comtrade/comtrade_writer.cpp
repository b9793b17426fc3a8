// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/comtrade/comtrade_writer.hpp"

#include <bit>
#include <cmath>
#include <ctime>
#include <fmt/format.h>

namespace gridspace {
namespace {

void put(std::string& out, std::uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) {
        out.push_back(static_cast<char>(value >> (8 * i) & 0xFF));
    }
}

/// Commas separate the fields of the .cfg.
std::string field(std::string text) {
    for (char& c : text) {
        c = c == ',' || c == '\n' || c == '\r' ? '_' : c;
    }
    return text;
}

std::string stamp(std::int64_t unix_s, double seconds) {
    double const whole = std::floor(seconds);
    std::time_t const t = static_cast<std::time_t>(unix_s + static_cast<std::int64_t>(whole));
    std::tm utc{};
    ::gmtime_r(&t, &utc);
    return fmt::format("{:02}/{:02}/{:04},{:02}:{:02}:{:09.6f}", utc.tm_mday, utc.tm_mon + 1, utc.tm_year + 1900,
                       utc.tm_hour, utc.tm_min, utc.tm_sec + (seconds - whole));
}

} // namespace

Result<ComtradeWriter> ComtradeWriter::create(std::filesystem::path file, ComtradeHeader header) {
    if (file.extension() == ".cfg" || file.extension() == ".dat") {
        file.replace_extension();
    }
    ComtradeWriter out;
    out.header_ = std::move(header);
    out.cfg_ = file;
    out.cfg_ += ".cfg";
    out.dat_ = file;
    out.dat_ += ".dat";
    out.data_.open(out.dat_, std::ios::binary);
    if (!out.data_) {
        return fail(ExitCode::environment, fmt::format("cannot write {}", out.dat_.string()),
                    "does the folder exist, and may you write there?");
    }
    return out;
}

void ComtradeWriter::row(std::span<double const> analog, std::span<bool const> digital) {
    record_.clear();
    put(record_, rows_ + 1, 4);
    double const microseconds = header_.sample_rate_hz > 0 ? rows_ / header_.sample_rate_hz * 1e6 : 0;
    put(record_, static_cast<std::uint32_t>(std::llround(microseconds)), 4);
    for (double const x : analog) {
        put(record_, std::bit_cast<std::uint32_t>(static_cast<float>(x)), 4);
    }
    for (std::size_t i = 0; i < digital.size(); i += 16) {
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 16 && i + k < digital.size(); ++k) {
            word |= digital[i + k] ? 1U << k : 0U;
        }
        put(record_, word, 2);
    }
    data_.write(record_.data(), static_cast<std::streamsize>(record_.size()));
    ++rows_;
}

Result<void> ComtradeWriter::finish() {
    data_.close();
    std::string text =
        fmt::format("{},{},2013\r\n{},{}A,{}D\r\n", field(header_.station), field(header_.device),
                    header_.analog.size() + header_.digital.size(), header_.analog.size(), header_.digital.size());
    int n = 0;
    for (ComtradeChannel const& c : header_.analog) {
        text += fmt::format("{},{},{},,{},1,0,0,-3.4028235E+38,3.4028235E+38,1,1,P\r\n", ++n, field(c.name),
                            field(c.phase), field(c.unit));
    }
    n = 0;
    for (ComtradeChannel const& c : header_.digital) {
        text += fmt::format("{},{},{},,0\r\n", ++n, field(c.name), field(c.phase));
    }
    text += fmt::format("{}\r\n1\r\n{},{}\r\n{}\r\n{}\r\nFLOAT32\r\n1\r\n0,0\r\n0,0\r\n", header_.line_frequency_hz,
                        header_.sample_rate_hz, rows_, stamp(header_.start_unix_s, 0),
                        stamp(header_.start_unix_s, header_.trigger_s));
    std::ofstream cfg{cfg_, std::ios::binary};
    cfg << text;
    cfg.close();
    if (!data_ || !cfg) {
        return fail(ExitCode::environment, fmt::format("cannot write {}", (data_ ? cfg_ : dat_).string()),
                    "is the disk full?");
    }
    return {};
}

} // namespace gridspace

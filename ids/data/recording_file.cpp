// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/data/recording_file.hpp"

#include "common/text.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <span>

namespace gridspace::ids {
namespace {

constexpr std::uintmax_t kMaxBytes = 2ULL << 30U;

void add_row(LineWaveform& out, std::span<double const> values) {
    out.from.push_back({values[0], values[1], values[2]});
    if (values.size() == 6) {
        out.to.push_back({values[3], values[4], values[5]});
    }
}

Result<LineWaveform> read_csv(std::filesystem::path const& file, RecordingOptions const& options) {
    std::ifstream stream{file};
    auto const bad = [&](std::size_t line, std::string const& what, std::string remedy = {}) {
        return fail(ExitCode::usage, fmt::format("{}:{}: {}", file.string(), line, what), std::move(remedy));
    };
    LineWaveform out;
    std::string text;
    std::size_t line = 0, columns = 0;
    std::vector<double> values;
    double first_s = 0, last_s = 0;
    bool header = false;
    while (std::getline(stream, text)) {
        ++line;
        std::string_view const row = trim(text);
        if (row.empty() || row.front() == '#') {
            continue;
        }
        auto const cells = split(row, row.find(';') != std::string_view::npos ? ';' : ',');
        if (!header) { // the first row names the columns
            header = true;
            columns = cells.size();
            if (columns != 4 && columns != 7) {
                return bad(line,
                           fmt::format("{} columns; 4 (time, a, b, c) or 7 (time, from a, b, c, to a, b, c) expected",
                                       columns));
            }
            double number = 0;
            std::string_view const cell = trim(cells[0]);
            if (std::from_chars(cell.data(), cell.data() + cell.size(), number).ec == std::errc{}) {
                return bad(line, "the first row holds numbers", "start with a header row: time_s,ia,ib,ic");
            }
            continue;
        }
        if (cells.size() != columns) {
            return bad(line, fmt::format("{} columns; the header has {}", cells.size(), columns));
        }
        values.clear();
        for (std::size_t c = 0; c < columns; ++c) {
            std::string_view const cell = trim(cells[c]);
            double v = std::numeric_limits<double>::quiet_NaN();
            auto const [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), v);
            bool const missing = cell.empty() || cell == "nan" || cell == "NaN" || cell == "NA";
            if ((error != std::errc{} || end != cell.data() + cell.size()) && !(missing && c > 0)) {
                return bad(line, fmt::format("column {}: '{}' is not a number", c + 1, cell));
            }
            values.push_back(missing ? std::numeric_limits<double>::quiet_NaN() : v);
        }
        if (out.size() == 0) {
            first_s = values[0];
        } else if (!(values[0] > last_s)) {
            return bad(line, fmt::format("time {} s after {} s; it must rise", values[0], last_s));
        }
        last_s = values[0];
        add_row(out, std::span{values}.subspan(1));
    }
    if (out.size() < 2) {
        return fail(ExitCode::usage, fmt::format("{}: {} samples", file.string(), out.size()),
                    "a recording needs at least two");
    }
    double const rate = static_cast<double>(out.size() - 1) / (last_s - first_s);
    if (options.rate_hz && std::fabs(*options.rate_hz - rate) > 0.001 * rate) {
        return fail(ExitCode::usage, fmt::format("{}: its times are {:.6g} samples a second, and {} were expected",
                                                 file.string(), rate, *options.rate_hz));
    }
    // Times are often rounded to microseconds: take the whole number that is meant.
    out.rate_hz = std::fabs(rate - std::round(rate)) < 1e-3 * rate ? std::round(rate) : rate;
    return out;
}

Result<LineWaveform> read_npy(std::filesystem::path const& file, RecordingOptions const& options) {
    auto const bad = [&](std::string const& what, std::string remedy = {}) {
        return fail(ExitCode::usage, fmt::format("{}: {}", file.string(), what), std::move(remedy));
    };
    if (!options.rate_hz) {
        return bad("npy files do not say their sampling rate", "give rate_hz");
    }
    std::ifstream stream{file, std::ios::binary};
    std::string const bytes{std::istreambuf_iterator<char>{stream}, {}};
    if (bytes.size() < 12 || bytes.compare(0, 6, "\x93NUMPY", 6) != 0) {
        return bad("not an npy file");
    }
    auto const byte = [&](std::size_t k) { return static_cast<std::size_t>(static_cast<unsigned char>(bytes[k])); };
    bool const version_1 = byte(6) == 1;
    std::size_t const start = version_1 ? 10 : 12;
    std::size_t const length =
        version_1 ? byte(8) + 256 * byte(9) : byte(8) + 256 * byte(9) + 65536 * byte(10) + 16777216 * byte(11);
    if (length > bytes.size() - start) {
        return bad("its header is cut off");
    }
    std::string const header = bytes.substr(start, length);
    bool const wide = header.find("'<f8'") != std::string::npos, narrow = header.find("'<f4'") != std::string::npos;
    if (!wide && !narrow) {
        return bad("only little-endian float32 and float64 are read", "save it with array.astype('<f8')");
    }
    if (header.find("'fortran_order': False") == std::string::npos) {
        return bad("it is stored by columns", "save it with numpy.ascontiguousarray");
    }
    std::size_t rows = 0, columns = 0;
    auto const open = header.find('(', header.find("'shape'"));
    if (open != std::string::npos) {
        char const* at = header.data() + open + 1;
        char const* const end = header.data() + header.size();
        auto r = std::from_chars(at, end, rows);
        at = r.ptr;
        while (at < end && (*at == ',' || *at == ' ')) {
            ++at;
        }
        std::from_chars(at, end, columns);
    }
    std::size_t const width = wide ? 8 : 4;
    if (columns != 3 && columns != 6) {
        return bad(fmt::format("shape ({}, {}); (samples, 3) or (samples, 6) expected", rows, columns));
    }
    if (rows > bytes.size() || rows * columns * width != bytes.size() - start - length) {
        return bad(fmt::format("{} bytes of data; {} x {} numbers of {} bytes expected", bytes.size() - start - length,
                               rows, columns, width));
    }
    LineWaveform out;
    out.rate_hz = *options.rate_hz;
    std::vector<double> values(columns);
    char const* at = bytes.data() + start + length;
    for (std::size_t k = 0; k < rows; ++k) {
        for (double& v : values) {
            float f = 0;
            if (wide) {
                std::memcpy(&v, at, 8);
            } else {
                std::memcpy(&f, at, 4);
                v = static_cast<double>(f);
            }
            at += width;
        }
        add_row(out, values);
    }
    if (rows < 2) {
        return bad(fmt::format("{} samples", rows), "a recording needs at least two");
    }
    return out;
}

} // namespace

Result<LineWaveform> read_recording(std::filesystem::path const& file, RecordingOptions const& options) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
        return fail(ExitCode::usage, fmt::format("{}: no such file", file.string()));
    }
    if (std::filesystem::file_size(file, error) > kMaxBytes) {
        return fail(ExitCode::usage, fmt::format("{}: larger than 2 GB", file.string()), "split it");
    }
    auto out = file.extension() == ".npy" ? read_npy(file, options) : read_csv(file, options);
    if (out) {
        out->name = file.filename().string();
        out->frequency_hz = options.frequency_hz;
        if (options.event_s) {
            out->event = static_cast<std::int64_t>(std::ceil(*options.event_s * out->rate_hz));
        }
    }
    return out;
}

} // namespace gridspace::ids

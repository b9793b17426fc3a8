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

std::unexpected<Error> bad_row(std::filesystem::path const& file, std::size_t line, std::string const& what,
                               std::string remedy = {}) {
    return fail(ExitCode::usage, fmt::format("{}:{}: {}", file.string(), line, what), std::move(remedy));
}

/// The first row names the columns.
Result<void> check_csv_header(std::filesystem::path const& file, std::size_t line,
                              std::vector<std::string> const& cells) {
    if (cells.size() != 4 && cells.size() != 7) {
        return bad_row(
            file, line,
            fmt::format("{} columns; 4 (time, a, b, c) or 7 (time, from a, b, c, to a, b, c) expected", cells.size()));
    }
    double number = 0;
    std::string_view const cell = trim(cells[0]);
    if (std::from_chars(cell.data(), cell.data() + cell.size(), number).ec == std::errc{}) {
        return bad_row(file, line, "the first row holds numbers", "start with a header row: time_s,ia,ib,ic");
    }
    return {};
}

/// A current may be missing, the time may not.
Result<void> read_csv_row(std::filesystem::path const& file, std::size_t line, std::vector<std::string> const& cells,
                          std::vector<double>& values) {
    values.clear();
    for (std::size_t c = 0; c < cells.size(); ++c) {
        std::string_view const cell = trim(cells[c]);
        double v = std::numeric_limits<double>::quiet_NaN();
        auto const [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), v);
        bool const missing = cell.empty() || cell == "nan" || cell == "NaN" || cell == "NA";
        if ((error != std::errc{} || end != cell.data() + cell.size()) && !(missing && c > 0)) {
            return bad_row(file, line, fmt::format("column {}: '{}' is not a number", c + 1, cell));
        }
        values.push_back(missing ? std::numeric_limits<double>::quiet_NaN() : v);
    }
    return {};
}

Result<double> rate_of_times(std::filesystem::path const& file, std::size_t samples, double first_s, double last_s,
                             std::optional<double> expected_hz) {
    double const rate = static_cast<double>(samples - 1) / (last_s - first_s);
    if (expected_hz && std::fabs(*expected_hz - rate) > 0.001 * rate) {
        return fail(ExitCode::usage, fmt::format("{}: its times are {:.6g} samples a second, and {} were expected",
                                                 file.string(), rate, *expected_hz));
    }
    // Times are often rounded to microseconds: take the whole number that is meant.
    return std::fabs(rate - std::round(rate)) < 1e-3 * rate ? std::round(rate) : rate;
}

Result<LineWaveform> read_csv(std::filesystem::path const& file, RecordingOptions const& options) {
    std::ifstream stream{file};
    LineWaveform out;
    std::string text;
    std::size_t line = 0, columns = 0; // none before the header
    std::vector<double> values;
    double first_s = 0, last_s = 0;
    while (std::getline(stream, text)) {
        ++line;
        std::string_view const row = trim(text);
        if (row.empty() || row.front() == '#') {
            continue;
        }
        auto const cells = split(row, row.find(';') != std::string_view::npos ? ';' : ',');
        if (columns == 0) {
            if (auto ok = check_csv_header(file, line, cells); !ok) {
                return std::unexpected{ok.error()};
            }
            columns = cells.size();
            continue;
        }
        if (cells.size() != columns) {
            return bad_row(file, line, fmt::format("{} columns; the header has {}", cells.size(), columns));
        }
        if (auto ok = read_csv_row(file, line, cells, values); !ok) {
            return std::unexpected{ok.error()};
        }
        if (out.size() == 0) {
            first_s = values[0];
        } else if (!(values[0] > last_s)) {
            return bad_row(file, line, fmt::format("time {} s after {} s; it must rise", values[0], last_s));
        }
        last_s = values[0];
        add_row(out, std::span{values}.subspan(1));
    }
    if (out.size() < 2) {
        return fail(ExitCode::usage, fmt::format("{}: {} samples", file.string(), out.size()),
                    "a recording needs at least two");
    }
    auto const rate = rate_of_times(file, out.size(), first_s, last_s, options.rate_hz);
    if (!rate) {
        return std::unexpected{rate.error()};
    }
    out.rate_hz = *rate;
    return out;
}

std::unexpected<Error> bad_npy(std::filesystem::path const& file, std::string const& what, std::string remedy = {}) {
    return fail(ExitCode::usage, fmt::format("{}: {}", file.string(), what), std::move(remedy));
}

/// What the header of an npy file says.
struct NpyLayout {
    std::size_t data; ///< offset of the numbers
    std::size_t rows, columns;
    std::size_t width; ///< octets of a number: 4 or 8
};

/// (rows, columns) of a header's shape; 0 for what it does not say.
std::pair<std::size_t, std::size_t> npy_shape(std::string const& header) {
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
    return {rows, columns};
}

Result<NpyLayout> read_npy_header(std::filesystem::path const& file, std::string const& bytes) {
    if (bytes.size() < 12 || bytes.compare(0, 6, "\x93NUMPY", 6) != 0) {
        return bad_npy(file, "not an npy file");
    }
    auto const byte = [&](std::size_t k) { return static_cast<std::size_t>(static_cast<unsigned char>(bytes[k])); };
    bool const version_1 = byte(6) == 1;
    std::size_t const start = version_1 ? 10 : 12;
    std::size_t const length =
        version_1 ? byte(8) + 256 * byte(9) : byte(8) + 256 * byte(9) + 65536 * byte(10) + 16777216 * byte(11);
    if (length > bytes.size() - start) {
        return bad_npy(file, "its header is cut off");
    }
    std::string const header = bytes.substr(start, length);
    bool const wide = header.find("'<f8'") != std::string::npos, narrow = header.find("'<f4'") != std::string::npos;
    if (!wide && !narrow) {
        return bad_npy(file, "only little-endian float32 and float64 are read", "save it with array.astype('<f8')");
    }
    if (header.find("'fortran_order': False") == std::string::npos) {
        return bad_npy(file, "it is stored by columns", "save it with numpy.ascontiguousarray");
    }
    auto const [rows, columns] = npy_shape(header);
    std::size_t const width = wide ? 8 : 4;
    if (columns != 3 && columns != 6) {
        return bad_npy(file, fmt::format("shape ({}, {}); (samples, 3) or (samples, 6) expected", rows, columns));
    }
    if (rows > bytes.size() || rows * columns * width != bytes.size() - start - length) {
        return bad_npy(file, fmt::format("{} bytes of data; {} x {} numbers of {} bytes expected",
                                         bytes.size() - start - length, rows, columns, width));
    }
    return NpyLayout{start + length, rows, columns, width};
}

Result<LineWaveform> read_npy(std::filesystem::path const& file, RecordingOptions const& options) {
    if (!options.rate_hz) {
        return bad_npy(file, "npy files do not say their sampling rate", "give rate_hz");
    }
    std::ifstream stream{file, std::ios::binary};
    std::string const bytes{std::istreambuf_iterator<char>{stream}, {}};
    auto const layout = read_npy_header(file, bytes);
    if (!layout) {
        return std::unexpected{layout.error()};
    }
    LineWaveform out;
    out.rate_hz = *options.rate_hz;
    std::vector<double> values(layout->columns);
    char const* at = bytes.data() + layout->data;
    for (std::size_t k = 0; k < layout->rows; ++k) {
        for (double& v : values) {
            float f = 0;
            if (layout->width == 8) {
                std::memcpy(&v, at, 8);
            } else {
                std::memcpy(&f, at, 4);
                v = static_cast<double>(f);
            }
            at += layout->width;
        }
        add_row(out, values);
    }
    if (layout->rows < 2) {
        return bad_npy(file, fmt::format("{} samples", layout->rows), "a recording needs at least two");
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

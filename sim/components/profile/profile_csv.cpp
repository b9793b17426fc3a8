// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/profile/profile_csv.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <optional>

namespace gridspace::sim {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF"; ///< what spreadsheets begin UTF-8 with

std::vector<std::string> cells_of(std::string_view row) {
    std::vector<std::string> out;
    for (std::string const& cell : split(row, ',')) {
        out.emplace_back(trim(cell));
    }
    return out;
}

/// Where the one column is that has one of these names.
Result<std::size_t> column_index(std::string const& file, std::vector<std::string> const& header,
                                 std::vector<std::string> const& names, std::string const& wanted) {
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < header.size(); ++i) {
        if (std::find(names.begin(), names.end(), header[i]) == names.end()) {
            continue;
        }
        if (found) {
            return fail(ExitCode::usage,
                        header[i] == header[*found]
                            ? fmt::format("'{}' has two columns '{}'", file, header[i])
                            : fmt::format("'{}' has a column '{}' and a column '{}'", file, header[*found], header[i]),
                        "which one is meant? rename or remove the other");
        }
        found = i;
    }
    if (!found) {
        return fail(ExitCode::usage, fmt::format("'{}' has no column {}", file, wanted),
                    fmt::format("its columns are {}", join(header, ", ")));
    }
    return *found;
}

std::optional<double> number(std::vector<std::string> const& row, std::size_t i) {
    double value = 0;
    if (i >= row.size()) {
        return std::nullopt;
    }
    auto const [end, error] = std::from_chars(row[i].data(), row[i].data() + row[i].size(), value);
    bool const good = error == std::errc{} && end == row[i].data() + row[i].size() && std::isfinite(value);
    return good ? std::optional{value} : std::nullopt;
}

} // namespace

Result<ProfilePoints> read_profile_csv(std::filesystem::path const& file, std::string const& column) {
    std::string const name = file.string();
    std::ifstream stream{file};
    std::string line;
    if (!stream || !std::getline(stream, line)) {
        return fail(ExitCode::usage, fmt::format("cannot read the profile '{}'", name));
    }
    std::string_view const first = line;
    std::vector<std::string> const header =
        cells_of(first.starts_with(kByteOrderMark) ? first.substr(kByteOrderMark.size()) : first);
    auto const time = column_index(name, header, {"hours", "h", "time_h"}, "'hours' (or 'h', 'time_h')");
    if (!time) {
        return std::unexpected{time.error()};
    }
    auto const value = column_index(name, header, {column}, "'" + column + "'");
    if (!value) {
        return std::unexpected{value.error()};
    }
    ProfilePoints points;
    for (int at = 2; std::getline(stream, line); ++at) {
        if (trim(line).empty()) {
            continue;
        }
        std::vector<std::string> const row = cells_of(line);
        for (std::size_t const i : {*time, *value}) {
            if (!number(row, i)) {
                return fail(ExitCode::usage,
                            fmt::format("{}:{}: column '{}' is '{}', expected a number", name, at, header[i],
                                        i < row.size() ? row[i] : ""),
                            "each row needs a time and a value, finite, with a point before decimals");
            }
        }
        double const hours = *number(row, *time);
        if (!points.hours.empty() && hours <= points.hours.back()) {
            return fail(
                ExitCode::usage,
                fmt::format("{}:{}: {} h comes after {} h", name, at, shortest(hours), shortest(points.hours.back())),
                "the hours of a profile increase from row to row");
        }
        points.hours.push_back(hours);
        points.values.push_back(*number(row, *value));
    }
    if (points.hours.empty()) {
        return fail(ExitCode::usage, fmt::format("'{}' has a header and no rows", name),
                    "a profile needs one point at least");
    }
    return points;
}

} // namespace gridspace::sim

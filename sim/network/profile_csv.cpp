// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/profile_csv.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fstream>

namespace gridspace::sim {
namespace {

std::size_t column_index(std::vector<std::string> const& header, std::vector<std::string> const& names) {
    for (std::size_t i = 0; i < header.size(); ++i) {
        if (std::find(names.begin(), names.end(), header[i]) != names.end()) {
            return i;
        }
    }
    return header.size();
}

} // namespace

Result<ProfilePoints> read_profile_csv(std::filesystem::path const& file, std::string const& column) {
    std::ifstream stream{file};
    std::string line;
    if (!stream || !std::getline(stream, line)) {
        return fail(ExitCode::usage, fmt::format("cannot read the profile '{}'", file.string()));
    }
    auto const cells = [](std::string const& row) {
        std::vector<std::string> out;
        for (std::string const& cell : split(row, ',')) {
            out.emplace_back(trim(cell));
        }
        return out;
    };
    std::vector<std::string> const header = cells(line);
    std::size_t const time = column_index(header, {"hours", "h", "time_h"});
    std::size_t const value = column_index(header, {column});
    if (time == header.size()) {
        return fail(ExitCode::usage, fmt::format("'{}' has no column 'hours'", file.string()),
                    fmt::format("its columns are {}", join(header, ", ")));
    }
    if (value == header.size()) {
        return fail(ExitCode::usage, fmt::format("'{}' has no column '{}'", file.string(), column),
                    fmt::format("its columns are {}", join(header, ", ")));
    }
    ProfilePoints points;
    for (int number = 2; std::getline(stream, line); ++number) {
        if (trim(line).empty()) {
            continue;
        }
        std::vector<std::string> const row = cells(line);
        auto const read = [&](std::size_t i, std::vector<double>& out) {
            double v = 0;
            if (i >= row.size()) {
                return false;
            }
            auto const [end, error] = std::from_chars(row[i].data(), row[i].data() + row[i].size(), v);
            out.push_back(v);
            return error == std::errc{} && end == row[i].data() + row[i].size();
        };
        if (!read(time, points.hours) || !read(value, points.values)) {
            return fail(ExitCode::usage, fmt::format("{}:{}: not a row of numbers: '{}'", file.string(), number, line));
        }
    }
    return points;
}

} // namespace gridspace::sim

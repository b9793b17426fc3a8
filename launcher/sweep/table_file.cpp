// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/table_file.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <optional>

namespace gridspace::launcher {
namespace {

/// The cells of a line; nothing when a quote is not closed in it.
std::optional<std::vector<std::string>> cells_of(std::string_view line) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        char const c = line[i];
        if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
            cells.back() += line[++i];
        } else if (c == '"') {
            quoted = !quoted;
        } else if (c == ',' && !quoted) {
            cells.emplace_back();
        } else {
            cells.back() += c;
        }
    }
    for (std::string& cell : cells) {
        cell = trim(cell);
    }
    return quoted ? std::nullopt : std::optional{std::move(cells)};
}

} // namespace

Result<std::vector<std::string>> read_column(std::filesystem::path const& file, std::string const& column,
                                             std::size_t most) {
    std::ifstream stream{file};
    auto const wrong = [&](std::size_t line, std::string const& what, std::string remedy = {}) {
        return fail(ExitCode::usage, fmt::format("{}:{}: {}", file.string(), line, what), std::move(remedy));
    };
    std::string text;
    if (!stream || !std::getline(stream, text)) {
        return fail(ExitCode::usage, fmt::format("'{}' cannot be read, or is empty", file.string()),
                    "a CSV file whose first row has the names of its columns");
    }
    if (text.starts_with("\xef\xbb\xbf")) { // a spreadsheet's mark of UTF-8
        text.erase(0, 3);
    }
    auto const header = cells_of(trim(text));
    if (!header) {
        return wrong(1, "a quote is not closed");
    }
    auto const count = std::count(header->begin(), header->end(), column);
    if (count == 0) {
        return wrong(1, fmt::format("there is no column '{}'", column), spelling_hint(column, *header));
    }
    if (count > 1) {
        return wrong(1, fmt::format("the column '{}' is there {} times", column, count), "rename one of them");
    }
    auto const place = static_cast<std::size_t>(std::find(header->begin(), header->end(), column) - header->begin());
    std::vector<std::string> out;
    for (std::size_t line = 2; std::getline(stream, text); ++line) {
        if (trim(text).empty()) {
            continue;
        }
        auto cells = cells_of(trim(text));
        if (!cells || cells->size() != header->size()) {
            return wrong(line, cells
                                   ? fmt::format("{} cells, where the first row has {}", cells->size(), header->size())
                                   : "a quote is not closed");
        }
        if ((*cells)[place].empty()) {
            return wrong(line, fmt::format("the cell of '{}' is empty", column));
        }
        if (out.size() == most) {
            return wrong(line, fmt::format("more than {} rows", most));
        }
        out.push_back(std::move((*cells)[place]));
    }
    if (out.empty()) {
        return wrong(1, "there is no row below the names");
    }
    return out;
}

} // namespace gridspace::launcher

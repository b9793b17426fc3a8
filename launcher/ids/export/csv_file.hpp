// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

namespace gridspace::dataset {

/// A table that is written as it comes; memory is bounded by its buffer.
class CsvFile {
  public:
    CsvFile(std::filesystem::path const& file, std::string_view columns)
        : file_{file}, stream_{file, std::ios::binary | std::ios::trunc} {
        text_ += columns;
        text_ += '\n';
    }
    /// A whole row, without the end of the line.
    template <class... Args>
    void row(fmt::format_string<Args...> format, Args&&... args) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
        text_ += '\n';
        ++rows_;
        if (text_.size() > kBuffer) {
            flush();
        }
    }
    [[nodiscard]] std::uint64_t rows() const { return rows_; }
    [[nodiscard]] Result<void> close() {
        flush();
        stream_.close();
        return stream_ ? Result<void>{}
                       : fail(ExitCode::environment, fmt::format("'{}' cannot be written", file_.string()),
                              "is the disk full?");
    }

  private:
    static constexpr std::size_t kBuffer = 1U << 18U;
    void flush() {
        stream_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
        text_.clear();
    }
    std::filesystem::path file_;
    std::ofstream stream_;
    std::string text_;
    std::uint64_t rows_{0};
};

/// A text that may stand in a cell: with quotes where it has a comma, a quote or an end of line.
[[nodiscard]] inline std::string cell(std::string const& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos) {
        return text;
    }
    std::string out = "\"";
    for (char const c : text) {
        out += c == '"' ? "\"\"" : std::string(1, c);
    }
    return out + '"';
}

/// Nanoseconds as seconds, exactly: "-0.000000001".
[[nodiscard]] inline std::string seconds_text(std::int64_t ns) {
    std::uint64_t const size = ns < 0 ? 0 - static_cast<std::uint64_t>(ns) : static_cast<std::uint64_t>(ns);
    return fmt::format("{}{}.{:09}", ns < 0 ? "-" : "", size / 1'000'000'000, size % 1'000'000'000);
}

} // namespace gridspace::dataset

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/diagnostics.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <tuple>

namespace gridspace::config {
namespace {

std::string plural(int n, std::string_view word) {
    return fmt::format("{} {}{}", n, word, n == 1 ? "" : "s");
}

} // namespace

std::string SourceMark::to_string() const {
    if (source == nullptr) {
        return "?";
    }
    return line == 0 ? source->name : fmt::format("{}:{}:{}", source->name, line, column);
}

void Diagnostics::error(SourceMark where, std::string message, std::string hint, int width) {
    items_.push_back({Severity::error, std::move(where), std::move(message), std::move(hint), width});
    ++errors_;
}

void Diagnostics::warning(SourceMark where, std::string message, std::string hint, int width) {
    items_.push_back({Severity::warning, std::move(where), std::move(message), std::move(hint), width});
}

std::vector<Diagnostic> Diagnostics::sorted() const {
    std::vector<Diagnostic> out = items_;
    auto const key = [](Diagnostic const& d) {
        return std::tuple{d.where.source == nullptr ? std::string{} : d.where.source->name, d.where.line,
                          d.where.column, d.message};
    };
    std::stable_sort(out.begin(), out.end(), [&](auto const& a, auto const& b) { return key(a) < key(b); });
    out.erase(std::unique(out.begin(), out.end(), [&](auto const& a, auto const& b) { return key(a) == key(b); }),
              out.end());
    return out;
}

std::string Diagnostics::render() const {
    std::string out;
    int errors = 0, warnings = 0;
    for (Diagnostic const& d : sorted()) {
        bool const is_error = d.severity == Severity::error;
        (is_error ? errors : warnings) += 1;
        out += fmt::format("{}: {}: {}\n", d.where.to_string(), is_error ? "error" : "warning", d.message);
        bool const has_line = d.where.source != nullptr && d.where.line >= 1 &&
                              static_cast<std::size_t>(d.where.line) <= d.where.source->lines.size();
        if (has_line) {
            std::string const& line = d.where.source->lines[static_cast<std::size_t>(d.where.line) - 1];
            out += fmt::format("{:>4} | {}\n", d.where.line, line);
            std::string const underline = "^" + std::string(static_cast<std::size_t>(std::max(0, d.width - 1)), '~');
            out += fmt::format("     | {}{}{}\n",
                               std::string(static_cast<std::size_t>(std::max(0, d.where.column - 1)), ' '), underline,
                               d.hint.empty() ? "" : " " + d.hint);
        } else if (!d.hint.empty()) {
            out += fmt::format("     | {}\n", d.hint);
        }
    }
    if (errors + warnings > 0) {
        out += plural(errors, "error");
        if (warnings > 0) {
            out += ", " + plural(warnings, "warning");
        }
        out += ".";
    }
    return out;
}

} // namespace gridspace::config

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/diagnostics.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <tuple>

namespace gridspace::config {
namespace {

constexpr std::size_t kWidestLine = 160;
constexpr std::size_t kMaxKept = 1000;

/// Two columns of one character each for "what the line says" and "what is wrong with it".
std::string pointed_line(std::string_view raw, Diagnostic const& d) {
    std::size_t begin = 0;
    auto const column = static_cast<std::size_t>(std::max(0, d.where.column - 1));
    if (raw.size() > kWidestLine) { // the part around the place
        begin = column > kWidestLine / 2 && column < raw.size() ? column - kWidestLine / 2 : 0;
        raw = raw.substr(begin, kWidestLine);
    }
    std::size_t const indent = column >= begin ? std::min(column - begin, raw.size()) : 0;
    std::size_t const room = raw.size() > indent ? raw.size() - indent : 1;
    std::string const underline(std::min<std::size_t>(room, static_cast<std::size_t>(std::max(1, d.width))) - 1, '~');
    return fmt::format("{:>4} | {}\n     | {}^{}{}{}\n", d.where.line, printable(raw), std::string(indent, ' '),
                       underline, d.hint.empty() ? "" : " ", d.hint);
}

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
    if (!full()) {
        items_.push_back({Severity::error, std::move(where), std::move(message), std::move(hint), width});
    }
    ++errors_;
}

void Diagnostics::warning(SourceMark where, std::string message, std::string hint, int width) {
    if (!full()) {
        items_.push_back({Severity::warning, std::move(where), std::move(message), std::move(hint), width});
    }
    ++warnings_;
}

bool Diagnostics::full() const {
    return items_.size() >= kMaxKept;
}

std::vector<Diagnostic> Diagnostics::sorted() const {
    std::vector<Diagnostic> out = items_;
    auto const key = [](Diagnostic const& d) {
        return std::tuple{d.where.source == nullptr ? std::string{} : d.where.source->name, d.where.line,
                          d.where.column, d.message};
    };
    std::stable_sort(out.begin(), out.end(), [&](auto const& a, auto const& b) { return key(a) < key(b); });
    // The same thing said of the same place: a default that several processes share is wrong once.
    out.erase(std::unique(out.begin(), out.end(),
                          [&](Diagnostic const& a, Diagnostic const& b) {
                              bool const same_place = a.where.source == b.where.source &&
                                                      a.where.line == b.where.line &&
                                                      a.where.column == b.where.column && a.where.line > 0;
                              return key(a) == key(b) ||
                                     (same_place && !a.hint.empty() && a.hint == b.hint && a.severity == b.severity);
                          }),
              out.end());
    return out;
}

std::string Diagnostics::render() const {
    std::string out;
    int errors = 0, warnings = 0;
    for (Diagnostic const& d : sorted()) {
        bool const is_error = d.severity == Severity::error;
        (is_error ? errors : warnings) += 1;
        out += fmt::format("{}: {}: {}\n", d.where.to_string(), is_error ? "error" : "warning", printable(d.message));
        bool const has_line = d.where.source != nullptr && d.where.line >= 1 &&
                              static_cast<std::size_t>(d.where.line) <= d.where.source->lines.size();
        if (has_line) {
            out += pointed_line(d.where.source->lines[static_cast<std::size_t>(d.where.line) - 1], d);
        } else if (!d.hint.empty()) {
            out += fmt::format("     | {}\n", d.hint);
        }
    }
    if (errors + warnings > 0) {
        out += plural(errors, "error");
        if (warnings > 0) {
            out += ", " + plural(warnings, "warning");
        }
        out += full() ? fmt::format("; {} more are not shown.", errors_ + warnings_ - static_cast<int>(kMaxKept)) : ".";
    }
    return out;
}

} // namespace gridspace::config

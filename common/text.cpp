// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

namespace gridspace {
namespace {

constexpr std::size_t kLongestWord = 64;    ///< that may be misspelt: longer texts are no names
constexpr std::size_t kMaxCandidates = 256; ///< that are compared: a hint is not worth more, in a file of mistakes

/// Optimal string alignment distance of two short words: insert, delete, replace, swap neighbours.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::array<std::array<std::size_t, kLongestWord + 1>, 3> rows; // the last three of the table
    for (std::size_t j = 0; j <= b.size(); ++j) {
        rows[0][j] = j;
    }
    for (std::size_t i = 1; i <= a.size(); ++i) {
        auto const &above = rows[(i - 1) % 3], &two_above = rows[(i + 1) % 3];
        auto& row = rows[i % 3];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            std::size_t const cost = a[i - 1] == b[j - 1] ? 0 : 1;
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + cost});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                row[j] = std::min(row[j], two_above[j - 2] + 1);
            }
        }
    }
    return rows[a.size() % 3][b.size()];
}

std::string plain(std::string_view text) {
    std::string out;
    for (char const c : text) {
        if (c != '_' && c != '-') {
            out.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
        }
    }
    return out;
}

} // namespace

std::optional<std::string> nearest_spelling(std::string_view word, std::vector<std::string> const& candidates) {
    std::optional<std::string> best;
    std::string const wanted = plain(word);
    if (word.size() > kLongestWord) {
        return best;
    }
    std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
    for (std::size_t i = 0; i < std::min(candidates.size(), kMaxCandidates); ++i) {
        std::string const& candidate = candidates[i];
        std::string const offered = plain(candidate);
        std::size_t const apart = std::max(wanted.size(), offered.size()) - std::min(wanted.size(), offered.size());
        if (candidate.size() > kLongestWord || apart >= best_distance) {
            continue;
        }
        std::size_t const distance = wanted == offered ? 0 : edit_distance(wanted, offered);
        if (distance < best_distance && distance < candidate.size()) {
            best_distance = distance;
            best = candidate;
        }
    }
    return best;
}

std::string did_you_mean(std::string_view word, std::vector<std::string> const& candidates,
                         std::string_view otherwise) {
    auto const near = nearest_spelling(word, candidates);
    return near ? "did you mean '" + *near + "'?" : std::string{otherwise};
}

std::string spelling_hint(std::string_view word, std::vector<std::string> const& candidates, std::string_view none) {
    if (candidates.empty()) {
        return std::string{none};
    }
    constexpr std::size_t kShown = 20;
    std::vector<std::string> const shown{
        candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(std::min(candidates.size(), kShown))};
    return did_you_mean(word, candidates,
                        "there are: " + join(shown, ", ") + (candidates.size() > kShown ? ", ..." : ""));
}

bool matches_glob(std::string_view pattern, std::string_view text) {
    std::size_t p = 0, t = 0, star = std::string_view::npos, mark = 0;
    while (t < text.size()) {
        if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
            ++p;
            ++t;
        } else if (p < pattern.size() && pattern[p] == '*') {
            star = p++;
            mark = t;
        } else if (star != std::string_view::npos) {
            p = star + 1;
            t = ++mark;
        } else {
            return false;
        }
    }
    while (p < pattern.size() && pattern[p] == '*') {
        ++p;
    }
    return p == pattern.size();
}

std::vector<std::string> split(std::string_view text, char separator) {
    std::vector<std::string> parts;
    std::size_t at = 0;
    while (true) {
        std::size_t const end = text.find(separator, at);
        parts.emplace_back(text.substr(at, end == std::string_view::npos ? end : end - at));
        if (end == std::string_view::npos) {
            return parts;
        }
        at = end + 1;
    }
}

std::string join(std::vector<std::string> const& parts, std::string_view separator) {
    std::string out;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        out += (i == 0 ? "" : separator);
        out += parts[i];
    }
    return out;
}

std::string_view trim(std::string_view text) {
    auto const blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
    while (!text.empty() && blank(text.front())) {
        text.remove_prefix(1);
    }
    while (!text.empty() && blank(text.back())) {
        text.remove_suffix(1);
    }
    return text;
}

bool is_identifier(std::string_view text) {
    auto const letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; };
    auto const digit = [](char c) { return c >= '0' && c <= '9'; };
    return !text.empty() && letter(text.front()) &&
           std::all_of(text.begin(), text.end(), [&](char c) { return letter(c) || digit(c); });
}

std::string as_file_name(std::string_view name) {
    std::string out{name};
    std::replace_if(
        out.begin(), out.end(),
        [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '-'; }, '_');
    return out;
}

std::string escape_markup(std::string_view text) {
    std::string out;
    for (char const c : text) {
        bool const control = static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t'; // XML allows none
        out += c == '<'    ? "&lt;"
               : c == '&'  ? "&amp;"
               : c == '>'  ? "&gt;"
               : c == '"'  ? "&quot;"
               : c == '\'' ? "&#39;"
               : control   ? "?"
                           : std::string{c};
    }
    return out;
}

std::string printable(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
        auto const c = static_cast<unsigned char>(text[i]);
        std::size_t const length = c < 0x80                ? 1
                                   : c >= 0xf0 && c < 0xf5 ? 4
                                   : c >= 0xe0 && c < 0xf0 ? 3
                                   : c >= 0xc2 && c < 0xe0 ? 2
                                                           : 0;
        bool complete = length > 0 && i + length <= text.size();
        for (std::size_t k = 1; complete && k < length; ++k) {
            complete = (static_cast<unsigned char>(text[i + k]) & 0xc0) == 0x80;
        }
        bool const control =
            c < 0x20 || c == 0x7f || (c == 0xc2 && complete && static_cast<unsigned char>(text[i + 1]) < 0xa0);
        if (c == '\t') {
            out += ' ';
        } else if (!complete || control) {
            out += '?';
        } else {
            out += text.substr(i, length);
        }
        i += complete ? length : 1;
    }
    return out;
}

std::string shortest(double value) {
    char buffer[40];
    // Without an exponent where people would not write one: 1000000, not 1e+06.
    double const size = value < 0 ? -value : value;
    bool const plain = size == 0 || (size >= 1e-5 && size < 1e15);
    auto const [end, error] = plain ? std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed)
                                    : std::to_chars(buffer, buffer + sizeof buffer, value);
    return error == std::errc{} ? std::string{buffer, end} : "?";
}

} // namespace gridspace

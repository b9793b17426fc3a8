// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace {

/// The candidate that a person most likely meant by `word`, or nothing when none is close.
[[nodiscard]] std::optional<std::string> nearest_spelling(std::string_view word,
                                                          std::vector<std::string> const& candidates);

/// The remedy for a name that does not exist: "did you mean 'x'?", or `otherwise`.
[[nodiscard]] std::string did_you_mean(std::string_view word, std::vector<std::string> const& candidates,
                                       std::string_view otherwise = "");

/// The same, or else the names that there are (the first twenty), or `none` when there are no candidates.
[[nodiscard]] std::string spelling_hint(std::string_view word, std::vector<std::string> const& candidates,
                                        std::string_view none = "");

/// Shell-style match of a whole text: '*' is any run of characters, '?' any one.
[[nodiscard]] bool matches_glob(std::string_view pattern, std::string_view text);

[[nodiscard]] std::vector<std::string> split(std::string_view text, char separator);
[[nodiscard]] std::string join(std::vector<std::string> const& parts, std::string_view separator);
[[nodiscard]] std::string_view trim(std::string_view text);

/// [A-Za-z_][A-Za-z0-9_]*: what a topic, process, host, link or element may be called (CycloneDDS refuses more).
[[nodiscard]] bool is_identifier(std::string_view text);

/// A name as part of a file's: what is no letter, digit, '_' or '-' becomes '_'.
[[nodiscard]] std::string as_file_name(std::string_view name);

/// Text for an element or a quoted attribute of HTML, SVG or XML.
[[nodiscard]] std::string escape_markup(std::string_view text);

/// A text as it may be shown on a terminal: control characters (which could do anything to it) and incomplete UTF-8
/// become '?', a tab a space. As many columns as the text has.
[[nodiscard]] std::string printable(std::string_view text);

/// The shortest decimal text that reads back as the same double ("0.1", "1e-06", "3").
[[nodiscard]] std::string shortest(double value);

} // namespace gridspace

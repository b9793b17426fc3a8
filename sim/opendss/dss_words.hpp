// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/diagnostics.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace gridspace::opendss {

/// A word of a command: `name=value`, or a value alone.
struct Word {
    std::string name;     ///< in lower case; empty when only a value was given
    std::string value;    ///< without its brackets or quotes
    bool enclosed{false}; ///< it stood in brackets or quotes: a list, or arithmetic
    config::SourceMark where;
};

/// The words of one line of a DSS script: separated by blanks and commas; `( )`, `[ ]`, `{ }`, `" "` and `' '` hold a
/// value together; `!`, or `//` before a word, begins a comment.
[[nodiscard]] std::vector<Word> words_of(std::string_view line, config::SourceMark const& start,
                                         config::Diagnostics& diagnostics);

/// The words inside a list: like words_of, but `|` stands alone and there are no names.
[[nodiscard]] std::vector<Word> items_of(Word const& list, config::Diagnostics& diagnostics);

[[nodiscard]] std::string lower(std::string_view text);

} // namespace gridspace::opendss

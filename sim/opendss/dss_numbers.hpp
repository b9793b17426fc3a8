// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/opendss/dss_words.hpp"

#include <optional>
#include <vector>

namespace gridspace::opendss {

/// A finite number as it is written: "0.5", ".5", "+1e-3".
[[nodiscard]] std::optional<double> number(std::string_view text);

/// What a word is worth: a number, or, in brackets or quotes, arithmetic in reverse Polish notation: `(8 1000 /)`. The
/// operators are those of OpenDSS: + - * / ^ sqr sqrt inv exp ln log10 pi, sin to atan2 in degrees, swap, rollup,
/// rolldn. Says what is wrong, and returns nothing.
[[nodiscard]] std::optional<double> evaluate(Word const& word, config::Diagnostics& diagnostics);

/// Rows of numbers: `[1 2 | 3 4]`; each may be arithmetic in brackets of its own.
[[nodiscard]] std::optional<std::vector<std::vector<double>>> rows_of(Word const& word,
                                                                      config::Diagnostics& diagnostics);

} // namespace gridspace::opendss

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/network/matlab_case.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace gridspace::sim {

inline constexpr char kMatlabContinued = '\v'; ///< stands for '...' and its line end: white space that ends no row

struct MatlabStatementMistake {
    int line; ///< on which evaluation stood
    std::string what;
};

/// Evaluates one statement of a case file that begins on `line`, and puts what it assigns into `out`: matrices,
/// numbers, parts of matrices, unit conversions. What it does not understand is returned.
[[nodiscard]] std::optional<MatlabStatementMistake> run_matlab_statement(std::string_view text, int line,
                                                                         MatlabCase& out);

} // namespace gridspace::sim

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

namespace CLI { // NOLINT(readability-identifier-naming): the library's
class Validator;
}

/// Checks of numbers on the command line. The library's own let "nan" pass, and name limits of 300 digits.
namespace gridspace::cli {

/// A number from `least` to `most`; otherwise "'-1' is not WHAT".
CLI::Validator number(double least, char const* what, double most = 1e9);

CLI::Validator positive();
CLI::Validator not_negative();

} // namespace gridspace::cli

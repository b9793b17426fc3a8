// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/command_line/command.hpp"

#include <limits>

/// Checks of numbers on the command line. The library's own let "nan" pass, and name limits of 300 digits.
namespace gridspace::cli {

using command_line::Check;
using command_line::existing_file;
using command_line::in_range;
using command_line::ipv4_address;
using command_line::one_of;

/// A number from `least` to `most`; otherwise "'-1' is not WHAT".
Check number(double least, char const* what, double most = 1e9);

Check positive();
Check not_negative();

} // namespace gridspace::cli

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

namespace gridspace::launcher {

/// Round numbers between low and high, about `count` of them. Hours ("h") are counted as clocks and calendars do, and
/// so are minutes ("min"): 0, 3, 6 … for a day.
[[nodiscard]] std::vector<double> ticks(double low, double high, int count, std::string_view unit = {});

/// Of a logarithmic axis between two decimal logarithms: its powers of ten, of a short one 2 and 5 times them too.
[[nodiscard]] std::vector<double> decades(double low, double high);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace gridspace::launcher {

/// A bar of so many columns, filled to an eighth of one. `share`: 0 to 1.
[[nodiscard]] std::string progress_bar(double share, int cells);

} // namespace gridspace::launcher

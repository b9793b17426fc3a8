// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "launcher/judge/results.hpp"

#include <string>

namespace gridspace::launcher {

/// The one-line diagram of the run's grid with the state at its end, as a part of the page, and as
/// report/figures/one_line.svg. Of a grid too big for a page, a line that says where it is drawn. Empty: a run without
/// a network.
[[nodiscard]] Result<std::string> one_line_figure(Results const& results);

} // namespace gridspace::launcher

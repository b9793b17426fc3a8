// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/report/figures.hpp"
#include "launcher/report/wire_timing.hpp"
#include "launcher/scenario/published.hpp"

#include <string>
#include <vector>

namespace gridspace::launcher {

/// The tables of the wire timing report, with the method of each below it.
[[nodiscard]] std::vector<ReportTable> wire_timing_tables(WireTiming const& timing, Published const& published);

/// Rate over time, intervals, retransmissions by packet number, delays over time.
[[nodiscard]] std::vector<Figure> wire_timing_figures(WireTiming const& timing, Results const& results,
                                                      Published const& published);

/// `wire_timing` of report/summary.json.
[[nodiscard]] std::string wire_timing_json(WireTiming const& timing);

} // namespace gridspace::launcher

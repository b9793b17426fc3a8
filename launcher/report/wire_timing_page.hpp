// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/published.hpp"
#include "launcher/judge/wire_timing.hpp"
#include "launcher/report/tables.hpp"

#include <string>
#include <vector>

namespace gridspace::launcher {

/// The tables of the wire timing report, with the method of each below it.
[[nodiscard]] std::vector<ReportTable> wire_timing_tables(WireTiming const& timing, Published const& published);

/// `wire_timing` of report/summary.json.
[[nodiscard]] std::string wire_timing_json(WireTiming const& timing);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/published.hpp"
#include "launcher/judge/wire_timing.hpp"
#include "launcher/report/tables.hpp"

#include <string>
#include <vector>

namespace gridspace::launcher {

/// From the fault to open poles, for each relay that tripped, with the method below it.
[[nodiscard]] std::vector<ReportTable> chain_tables(WireTiming const& timing, Published const& published);
/// Streams and delays; in lockstep, where delays are declared, streams alone.
[[nodiscard]] std::vector<ReportTable> wire_timing_tables(WireTiming const& timing, Published const& published);

/// `wire_timing` of report/summary.json.
[[nodiscard]] std::string wire_timing_json(WireTiming const& timing);

} // namespace gridspace::launcher

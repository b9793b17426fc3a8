// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/results.hpp"
#include "launcher/report/tables.hpp"

namespace gridspace::launcher {

/// How late the ticks of a run in real time were, with what this machine can do by `gridspace doctor --latency`.
/// No rows in lockstep, and for recordings that do not hold it.
[[nodiscard]] ReportTable real_time_table(Results const& results);

} // namespace gridspace::launcher

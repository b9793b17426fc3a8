// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/consequences.hpp"
#include "launcher/judge/intrusion_score.hpp"
#include "launcher/report/tables.hpp"

#include <vector>

namespace gridspace::launcher {

/// Confusion matrices, attacks, and what the relays did.
[[nodiscard]] std::vector<ReportTable> detector_tables(IntrusionScore const& score);

/// Trips, loads and alarms of an attacked run.
[[nodiscard]] std::vector<ReportTable> consequence_tables(Consequences const& consequences);

} // namespace gridspace::launcher

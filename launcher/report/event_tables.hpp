// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"
#include "launcher/judge/results.hpp"
#include "launcher/report/tables.hpp"

namespace gridspace::launcher {

/// What happened, with times also since the first event of the scenario's timeline, which caused the others. An event
/// of the timeline says what it did.
[[nodiscard]] ReportTable event_table(Results const& results, config::Node const& scenario);
/// Of a long list, what the scenario did and what was switched.
[[nodiscard]] ReportTable main_events(Results const& results, config::Node const& scenario);

} // namespace gridspace::launcher

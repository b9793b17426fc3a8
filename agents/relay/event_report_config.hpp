// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <filesystem>

namespace gridspace::relay {

/// The relay's own disturbance record: what it saw and did around a trip.
struct EventReportConfig {
    enum class Trigger { off, pickup, trip } trigger{Trigger::trip};
    double before_ms{100}, after_ms{200};
    std::filesystem::path folder; ///< empty: event_reports/ of the run folder; without a run, none is written
};
/// The key `event_report`.
void describe(config::Fields& f, EventReportConfig& config);

} // namespace gridspace::relay

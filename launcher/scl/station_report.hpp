// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scl/station_scenario.hpp"

namespace gridspace::launcher {

/// What was taken over of a station, and what was not and why: for people, and as JSON.
[[nodiscard]] std::string report_text(scl::Station const& station, StationScenario const& scenario);
[[nodiscard]] std::string report_json(scl::Station const& station, StationScenario const& scenario);

/// Findings alone, each with its line, as mistakes in scenarios are shown.
[[nodiscard]] std::string findings_text(std::vector<scl::Finding> const& findings, std::size_t dropped);
[[nodiscard]] std::size_t count_of(std::vector<scl::Finding> const& findings, scl::Finding::Kind kind);

} // namespace gridspace::launcher

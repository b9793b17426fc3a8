// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"
#include "launcher/report/html_page.hpp"

#include <string>

namespace gridspace::launcher {

/// A setting as a relay's manual would say it, with the key of the configuration: "slope 2 from 500 A (slope2_from_a)".
[[nodiscard]] std::string setting_text(std::string const& key, config::Node const& value);

/// What each relay of a scenario measures, how it is set, and what it trips.
[[nodiscard]] ReportTable relay_settings_table(config::Node const& scenario);

} // namespace gridspace::launcher

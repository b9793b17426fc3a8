// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace gridspace::launcher {

/// Contents of assets/report.css and assets/report.js; made by CMake.
extern std::string_view const kReportCss;
extern std::string_view const kReportJs;

} // namespace gridspace::launcher

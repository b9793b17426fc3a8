// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace gridspace::launcher {

/// Contents of assets/report.css, assets/report.js and assets/usual_figures.yaml; made by CMake.
extern std::string_view const kReportCss;
extern std::string_view const kReportJs;
extern std::string_view const kUsualFigures;

} // namespace gridspace::launcher

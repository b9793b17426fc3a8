// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace gridspace::launcher {

/// Contents of assets/study.css and assets/study.js; made by CMake.
extern std::string_view const kStudyCss;
extern std::string_view const kStudyJs;

} // namespace gridspace::launcher

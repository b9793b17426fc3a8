// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace gridspace::launcher {

/// JSON schemas of the kinds of file that users write, for editors; and docs/reference/config.md. All are made from
/// the descriptions that read the files, so they cannot say anything else.
[[nodiscard]] std::string scenario_schema();
[[nodiscard]] std::string network_schema();
[[nodiscard]] std::string router_schema();
[[nodiscard]] std::string study_schema();
[[nodiscard]] std::string certify_schema();
[[nodiscard]] std::string config_page();
[[nodiscard]] std::string actions_page();

} // namespace gridspace::launcher

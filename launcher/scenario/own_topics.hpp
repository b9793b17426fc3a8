// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/diagnostics.hpp"

#include <filesystem>
#include <map>
#include <string>

namespace gridspace::launcher {

struct Scenario;

/// The IDL file of each type that is not Gridspace's, by the name of the type: what `exec` processes name beside their
/// topics. Absolute paths.
[[nodiscard]] std::map<std::string, std::filesystem::path> own_types(Scenario const& scenario);

/// Topics of the framework are nobody's to write, every type is known by some IDL, and everybody means the same by it.
void check_own_topics(Scenario const& scenario, config::Diagnostics& diagnostics);

} // namespace gridspace::launcher

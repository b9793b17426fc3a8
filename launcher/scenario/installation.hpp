// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace gridspace::launcher {

/// Where the programs of this Gridspace are: beside the running executable.
[[nodiscard]] std::filesystem::path program_file(std::string_view program);

/// The QoS profiles of a role: GRIDSPACE_QOS_DIR, the installed share folder, or the source tree.
[[nodiscard]] std::filesystem::path qos_file(std::string_view role);

/// A program of the system, also where an ordinary user's PATH does not look (/usr/sbin); empty when there is none.
[[nodiscard]] std::filesystem::path system_program(std::string_view name);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace gridspace::launcher {

/// Where the programs of this Gridspace are: next to the running executable.
[[nodiscard]] std::filesystem::path program_file(std::string_view program);

/// The QoS profiles of a role: GRIDSPACE_QOS_DIR, the installed share folder, or the source tree.
[[nodiscard]] std::filesystem::path qos_file(std::string_view role);

/// The folder that this Gridspace is installed in, or built: `bin` and `lib` are in it.
[[nodiscard]] std::filesystem::path prefix_folder();

/// The library that runs an exported network (gridspace_grid.so), in this installation or build; where it is expected
/// when there is none.
[[nodiscard]] std::filesystem::path grid_library();

/// A folder that is installed next to the programs (share/gridspace), or in the source tree: "templates", "python".
[[nodiscard]] std::filesystem::path shared_folder(std::string_view name);

/// Puts what agents of a scenario need into this process's environment, from where they inherit it: the Python package
/// (first in PYTHONPATH) and libgridspace (GRIDSPACE_LIBRARY, unless it is there), of this installation or source tree.
void offer_agent_libraries();

/// A program of the system, also where an ordinary user's PATH does not look (/usr/sbin); empty when there is none.
[[nodiscard]] std::filesystem::path system_program(std::string_view name);

} // namespace gridspace::launcher

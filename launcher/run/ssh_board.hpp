// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "launcher/scenario/addresses.hpp"
#include "launcher/scenario/scenario.hpp"

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::launcher {

/// Folder of its bundle on the board, by process.
using BoardBundles = std::map<std::string, std::string>;

/// Reaches every board that the scenario's processes run on (`run_on: ssh:HOST`), looks at what it is, and copies what
/// is not there yet. Each step has a deadline, and an error names the board and the step. `note` is called with what
/// takes long.
[[nodiscard]] Result<BoardBundles> prepare_boards(Scenario const& scenario,
                                                  std::function<void(std::string_view)> const& note);

/// The command that runs a program of ours on a board, which takes over the interfaces of the host: to be started in
/// the host's network namespace, as root, with GRIDSPACE_OUTER_NETWORK set.
[[nodiscard]] std::vector<std::string> ssh_board_command(std::vector<std::string> const& command,
                                                         std::filesystem::path const& config_file,
                                                         Process const& process, std::string const& bundle,
                                                         std::vector<Port> const& ports, double member_timeout_s);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/run/progress.hpp"
#include "launcher/run/run_folder.hpp"
#include "launcher/scenario/scenario.hpp"

#include <filesystem>

namespace gridspace::launcher {

struct RunOptions {
    std::filesystem::path parent{"runs"}; ///< run folders go here
    std::filesystem::path out;            ///< or exactly here
    Progress::Style style{Progress::Style::plain};
    bool namespaces{true};                ///< false: --no-namespaces
    std::string allow_attacks_on;         ///< a real interface
    std::string log_level{"info"};
    bool allow_control{false};            ///< --allow-control
};

struct FinishedRun {
    std::filesystem::path folder;
    RunOutcome outcome;
};

/// Runs a scenario from start to end: folder, sockets, namespaces, processes, progress. Fails when it cannot even start;
/// otherwise the outcome says how it went.
[[nodiscard]] Result<FinishedRun> run_scenario(Scenario const& scenario, RunOptions const& options);

} // namespace gridspace::launcher

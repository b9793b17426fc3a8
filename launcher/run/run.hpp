// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/run/interrupt_watch.hpp"
#include "launcher/run/progress.hpp"
#include "launcher/run/run_folder.hpp"
#include "launcher/scenario/scenario.hpp"

#include <filesystem>
#include <optional>

namespace gridspace::launcher {

struct RunOptions {
    std::filesystem::path parent{"runs"}; ///< run folders go here
    std::filesystem::path out;            ///< or exactly here
    Progress::Style style{Progress::Style::plain};
    bool namespaces{true};        ///< false: --no-namespaces
    std::string allow_attacks_on; ///< a real interface
    std::string log_level{"info"};
    bool allow_control{false}; ///< --allow-control
};

struct FinishedRun {
    std::filesystem::path folder;
    RunOutcome outcome;
    std::optional<Error> unwritten; ///< why the run folder does not know the outcome
    std::string unread;             ///< what was said on standard error, and waits for somebody to read there
};

/// Whether the scenario can run like that: without namespaces there are no hosts with interfaces of their own.
[[nodiscard]] Result<void> check_isolation(Scenario const& scenario, bool namespaces);

/// Runs a scenario from start to end: folder, sockets, namespaces, processes, progress. Fails when it cannot even
/// start; otherwise the outcome says how it went. `interrupts` end it.
[[nodiscard]] Result<FinishedRun> run_scenario(Scenario const& scenario, RunOptions const& options,
                                               InterruptWatch& interrupts);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "launcher/run/run_plan.hpp"
#include "launcher/scenario/scenario.hpp"

#include <filesystem>
#include <string>

namespace gridspace::launcher {

/// Makes `parent/<scenario>-<utc>` (with a number when it exists) and points `parent/latest` to it. With `exact`, makes
/// that folder, which must not exist or be empty.
[[nodiscard]] Result<std::filesystem::path>
make_run_folder(std::string const& scenario, std::filesystem::path const& parent, std::filesystem::path const& exact);

/// Writes what is known before the start: scenario.resolved.yaml, the network file, the process files, manifest.json.
[[nodiscard]] Result<void> write_inputs(Scenario const& scenario, RunPlan const& plan, bool root);

/// How the run went; completes manifest.json.
struct RunOutcome {
    int exit_code{0};
    std::string cause, remedy;
    double wall_s{0};       ///< from the start of the simulator's clock to its end
    double total_wall_s{0}; ///< of everything
    double simulated_s{0};
    std::uint64_t overruns{0};
    struct ProcessEnd {
        std::string process, how;
        int code{0};
        double cpu_s{0}; ///< user and system time
    };
    std::vector<ProcessEnd> ends;
};
[[nodiscard]] Result<void> write_outcome(std::filesystem::path const& folder, RunOutcome const& outcome);

/// SHA-256 of a file as hex; empty when it cannot be read.
[[nodiscard]] std::string sha256_of(std::filesystem::path const& file);

} // namespace gridspace::launcher

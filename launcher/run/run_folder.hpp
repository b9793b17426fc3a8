// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "launcher/folder/run_outcome.hpp"
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

[[nodiscard]] Result<void> write_outcome(std::filesystem::path const& folder, RunOutcome const& outcome);

} // namespace gridspace::launcher

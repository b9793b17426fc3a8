// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/scenario/scenario.hpp"

#include <memory>

namespace gridspace::cli {

/// Loads the scenario of a command line; prints what is wrong with it and returns nothing.
[[nodiscard]] std::unique_ptr<launcher::Scenario> load(ScenarioArguments const& arguments);

/// Prints an error and returns its exit code.
int print_error(Error const& error);

/// A run folder from what the user wrote: a folder, or the name of a run in runs/ ("latest").
[[nodiscard]] std::filesystem::path run_folder(std::filesystem::path const& written);

/// The same for a verb that reads or writes in the folder, whoever has filled it: an error when something in it leads
/// out of it. A file is taken as it is.
[[nodiscard]] Result<std::filesystem::path> closed_run(std::filesystem::path const& written);

} // namespace gridspace::cli

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scenario/scenario.hpp"

namespace gridspace::launcher {

/// The whole file, by the programs that it names. `root` is what is read; `start_programs` false: programs of somebody
/// else are refused.
void describe_scenario(config::Fields& f, Scenario& s, config::Node const& root, bool start_programs,
                       config::Diagnostics& diagnostics);

} // namespace gridspace::launcher

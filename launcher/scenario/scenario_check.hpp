// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scenario/scenario.hpp"

namespace gridspace::launcher {

/// What no single key shows: names that refer to something, times that divide, addresses, the network's power flow, the
/// dataflow, the expectations. May complete the processes with what follows from the network.
void check_scenario(Scenario& scenario, config::Diagnostics& diagnostics);

} // namespace gridspace::launcher

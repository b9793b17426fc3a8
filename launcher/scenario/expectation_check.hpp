// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scenario/known_signals.hpp"

namespace gridspace::launcher {

/// Signals, events and verbs must make sense for the scenario.
void check_expectations(Scenario const& scenario, KnownSignals const& known, config::Diagnostics& diagnostics);

} // namespace gridspace::launcher

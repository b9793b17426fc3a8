// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/relay_program.hpp"
#include "launcher/scenario/scenario.hpp"

namespace gridspace::sim {
struct Ct;
}

namespace gridspace::launcher {

/// What a line relay would measure in the steady state before anything happens: the power flow of the network through
/// both transformers into the relay's own element. A warning when that picks up (a polarity that is given wrongly,
/// streams of two lines, a pickup below the charging current), and when both ends are the same one.
void check_healthy_current(Scenario const& scenario, Process const& process, relay::RelayConfig const& config,
                           sim::Ct const& from, sim::Ct const& to, relay::ElementParams const& element,
                           config::Diagnostics& diagnostics);

} // namespace gridspace::launcher

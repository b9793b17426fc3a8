// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scenario/dataflow.hpp"

#include <cstdint>
#include <map>
#include <string>

/// How long a tick of lockstep may be (docs/design/time.md, "How long a tick may be").
namespace gridspace::launcher {

/// Of sampled values, that a process sends.
[[nodiscard]] Rational frames_per_second(Scenario const& scenario, Process const& process);

/// How far beyond a tick members work, where the tick is longer than the last hop of a loop.
struct WorkAhead {
    std::map<std::string, Rational> ahead_s;   ///< by member: its input is complete so long beyond the tick
    std::map<std::string, Rational> promise_s; ///< by member: its output is, so long beyond its own tick; only where
                                               ///< somebody counts on it
};

/// Of the scenario's tick. Empty where no loop needs it.
[[nodiscard]] WorkAhead work_ahead(Scenario const& scenario, Dataflow const& flow);

/// Every loop through the simulator takes at least a tick: from what a member hears in a tick to what it then does to
/// the simulator. A loop that is shorter is named hop by hop.
void check_loops(Scenario const& scenario, Dataflow const& flow, config::Diagnostics& diagnostics);

/// `tick_samples: auto`: the longest tick that every loop, message, buffer and event of the scenario allows, in samples
/// of simulation.sampling. All its programs must have been read.
[[nodiscard]] std::int64_t longest_tick_samples(Scenario const& scenario);

} // namespace gridspace::launcher

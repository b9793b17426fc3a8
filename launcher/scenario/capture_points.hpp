// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scenario/program.hpp"
#include "launcher/scenario/scenario.hpp"

#include <string>
#include <vector>

namespace gridspace::launcher {

/// A place where the recorder sees frames. Every frame of a link is seen once at the switch, at the port of who sent
/// it. Where a process sits in a cable, the host's side of it is a place of its own: what the host sent before, and
/// what it got after. A real interface of a host is one, too, both ways.
struct CapturePoint {
    std::string name, description; ///< in the capture file
    std::string host;              ///< in whose network the interface is; empty: where the switches are
    std::string interface;
    std::string link;      ///< incoming frames in the ledgers of lockstep; empty: they are seen elsewhere
    bool both_ways{false}; ///< outgoing frames too
    std::string link_out;  ///< and these in the ledgers
};

/// What the recorder process captures: `capture:` names links; without it, in real time every link, and in lockstep
/// those with frames that have a place in simulated time. Cut cables of these links and real interfaces come by
/// themselves.
[[nodiscard]] std::vector<CapturePoint> capture_points(Scenario const& scenario, Process const& recorder);

/// A link that is named and of which nothing can be captured is worth a warning. Names that do not exist are somebody
/// else's.
void check_capture(Scenario const& scenario, Process const& recorder, config::Diagnostics& diagnostics);

} // namespace gridspace::launcher

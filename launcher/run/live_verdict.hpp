// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scenario/scenario.hpp"

#include <filesystem>
#include <sys/types.h>

namespace gridspace::launcher {

/// A process next to a run that is watched: it judges the expectations by the recording so far and writes what it finds
/// to `so_far.json` of the run folder, for the monitor. It uses a twentieth of a processor at most, with the lowest
/// priority, and nobody waits for it: whatever becomes of it, the run goes on and is judged when it has ended. It and
/// its file are gone when this object is.
class LiveVerdict {
  public:
    /// Of a run without a monitor or expectations: nothing is started.
    LiveVerdict(Scenario const& scenario, std::filesystem::path const& folder);
    ~LiveVerdict();
    LiveVerdict(LiveVerdict const&) = delete;
    LiveVerdict& operator=(LiveVerdict const&) = delete;

  private:
    std::filesystem::path file_;
    pid_t pid_{-1};
};

} // namespace gridspace::launcher

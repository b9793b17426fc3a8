// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/folder/event_log.hpp"
#include "launcher/run/interrupt_watch.hpp"
#include "launcher/run/progress.hpp"
#include "launcher/run/run.hpp"
#include "launcher/run/run_plan.hpp"

#include <sys/types.h>

namespace gridspace::launcher {

/// Follows the supervisor of a run until it is gone: shows how far the run is, writes its events. `channel`: where the
/// supervisor reports it, and where it is asked to stop. Returns how the run ended.
RunOutcome follow(RunPlan const& plan, pid_t supervisor, int channel, Progress& progress, EventLog& events,
                  InterruptWatch& interrupts);

} // namespace gridspace::launcher

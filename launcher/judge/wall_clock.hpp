// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "recorder/signals/signal_store.hpp"

#include <filesystem>

namespace gridspace::launcher {

/// Adds what processes measured by the wall clock and by processor time, which is not part of a recording because it
/// never repeats: `wall_clock/<process>.csv` of the run folder, lines of signal, unit, value. One value each, at the
/// end of the run.
void add_wall_clock_values(std::filesystem::path const& folder, double end_s, SignalStore& signals);

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/duration_histogram.hpp"

#include <string>
#include <vector>

namespace gridspace {

/// How long something took in a process, as the report shows it: PREFIXp50, PREFIXp99 and PREFIXmax, microseconds.
struct NamedDurations {
    std::string prefix;
    DurationHistogram const* durations{nullptr};
};

/// Writes RUN/wall_clock/NAME.csv, lines of signal, unit, value: what differs from run to run stays out of the
/// recording. Those that nothing was measured of are left out; nothing is written without a run folder. A file that
/// cannot be written is said in the log.
void write_wall_clock(std::string const& name, std::vector<NamedDurations> const& all);

} // namespace gridspace

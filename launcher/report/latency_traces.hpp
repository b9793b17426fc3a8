// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "recorder/signals/signal_store.hpp"

#include <filesystem>
#include <vector>

namespace gridspace::launcher {

/// Of each stream with a signal wire_delay_ms two files in `folder`: STREAM.csv (time_s, latency_us), and
/// STREAM.svtrace, a line of whole microseconds for each sample or message, as SEAPATH's svtrace records them. Returns
/// their names.
[[nodiscard]] Result<std::vector<std::filesystem::path>> write_latency_traces(SignalStore const& signals,
                                                                              std::filesystem::path const& folder);

} // namespace gridspace::launcher

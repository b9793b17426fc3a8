// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/folder/event_log.hpp"
#include "recorder/signals/signal_store.hpp"

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// A process was killed by the timeline, and maybe started again.
struct ProcessEnd {
    std::int64_t time_ns{0};
    bool again{false};
};
[[nodiscard]] std::vector<ProcessEnd> ends_of(std::string const& process, std::vector<LoggedEvent> const& events);

/// A signal has no value from the end of its process, or its last row, until a row of the next one, if there is one.
struct Silence {
    std::int64_t from_ns{0}, until_ns{0};
};
using Silences = std::map<std::string, std::vector<Silence>>; ///< by signal

/// Of the signals of processes that were killed and not started again at once. `published`: signals by process. A
/// signal that two processes publish is nobody's.
[[nodiscard]] Silences silences(SignalStore const& signals,
                                std::map<std::string, std::set<std::string>> const& published,
                                std::vector<LoggedEvent> const& events);

} // namespace gridspace::launcher

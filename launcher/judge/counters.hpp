// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/folder/event_log.hpp"
#include "launcher/judge/expectation.hpp"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// Whether a signal counts from the start of its process: stream.X.lost, link.X.seen, publisher.X.sent and the like.
[[nodiscard]] bool is_counter(std::string_view signal);

/// What a process counted between its last row and its end by the timeline went with it.
struct CounterGap {
    std::string process;
    double from_s{0}, until_s{0};
    [[nodiscard]] std::string to_string() const; ///< "what relay1 counted from 0 s to 0.4 s"
};
using CounterGaps = std::map<std::string, std::vector<CounterGap>>; ///< by signal

/// Lets every counter go on where its process was started again: a new incarnation begins at zero, and what the earlier
/// ones counted is added. Gives what is known of no incarnation. `published`: signals by process.
[[nodiscard]] CounterGaps continue_counters(SignalStore& signals,
                                            std::map<std::string, std::set<std::string>> const& published,
                                            std::vector<LoggedEvent> const& events);

/// An expectation about counters with a gap passes only if it would whatever was counted there.
void mind_gaps(Expectation const& expectation, CounterGaps const& gaps, ExpectationResult& result);

} // namespace gridspace::launcher

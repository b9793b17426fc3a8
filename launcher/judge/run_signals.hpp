// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/results.hpp"
#include "recorder/signals/signal_store.hpp"

#include <string>
#include <vector>

namespace gridspace::launcher {

/// What results hold of the signals of their run: all, but of those of the simulator that neither the scenario names
/// nor a judge or the report looks at only the last value. Their names are added to `results.last_values`. The rule
/// must not outlive the results.
[[nodiscard]] KeepRule needed_signals(Results& results, AlsoNamed also_named);

/// The signals that match one of the patterns, at least what holds in the spans: for what names signals that the
/// scenario does not. What the results do not hold is read from the recording.
[[nodiscard]] Result<SignalStore> signals_within(Results const& results, std::vector<std::string> const& patterns,
                                                 Spans const& spans);

} // namespace gridspace::launcher

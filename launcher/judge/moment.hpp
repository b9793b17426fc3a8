// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "launcher/folder/event_log.hpp"

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::launcher {

/// "fault", "fault + 2 s", "relay2.trip - 1 ms": an instant relative to something that happened; "4 h": of simulated
/// time.
struct Moment {
    std::string event; ///< empty: the start of the run
    double offset_s{0};
};
[[nodiscard]] std::optional<Moment> parse_moment(std::string_view text);
[[nodiscard]] std::string to_text(Moment const& moment);

/// A key that holds a moment.
void describe_moment(config::Fields& f, std::string_view key, std::optional<Moment>& out, std::string_view doc);

/// When things happened, by name: events of the timeline, and "process.kind" of what processes reported (the first
/// time).
using Moments = std::map<std::string, double>;

/// Of `events:` of a scenario (may be nullptr) and of what has been reported.
[[nodiscard]] Moments moments_of(config::Node const* timeline, std::vector<LoggedEvent> const& reported);

/// Seconds of simulated time; nothing when it did not happen.
[[nodiscard]] std::optional<double> instant_of(Moment const& moment, Moments const& moments);

} // namespace gridspace::launcher

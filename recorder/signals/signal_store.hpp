// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace {

/// A recorded signal: values that hold from their time on. Times are nanoseconds of simulated time, increasing.
struct SignalSeries {
    std::string unit;
    std::vector<std::int64_t> times_ns;
    std::vector<double> values;
};

using SignalStore = std::map<std::string, SignalSeries>;

/// Rates, ages and delays of the wall clock: in lockstep there are none.
[[nodiscard]] bool is_wall_clock_signal(std::string_view name);

/// Adds what follows from both ends of a stream: stream.<name>.wire_delay_ms, from the sender's publish_age_ms and the
/// receiver's arrival_age_ms of the same sample, or from sent_after_ms and heard_after_ms of the same GOOSE message.
void derive_wire_delays(SignalStore& signals);

/// Reads the signals of a recording whose name `wanted` accepts.
[[nodiscard]] Result<SignalStore> read_signals(std::filesystem::path const& mcap,
                                               std::function<bool(std::string const&)> const& wanted);

} // namespace gridspace

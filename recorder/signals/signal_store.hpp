// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace gridspace {

/// A recorded signal: values that hold from their time on. Times are nanoseconds of simulated time, increasing.
struct SignalSeries {
    std::string unit;
    std::vector<std::int64_t> times_ns;
    std::vector<double> values;
};

using SignalStore = std::map<std::string, SignalSeries>;

/// Reads the signals of a recording whose name `wanted` accepts.
[[nodiscard]] Result<SignalStore> read_signals(std::filesystem::path const& mcap,
                                               std::function<bool(std::string const&)> const& wanted);

} // namespace gridspace

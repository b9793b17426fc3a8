// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/functions/function_set.hpp"
#include "common/config/node.hpp"
#include "recorder/signals/signal_store.hpp"

#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// A relay with `functions:`, as it was set.
struct BayFunctions {
    std::string relay;
    relay::FunctionSet functions;
    std::vector<std::string> breakers; ///< that it trips
};

/// Those of a resolved scenario whose name fits the pattern.
[[nodiscard]] std::vector<BayFunctions> bay_functions(config::Node const& scenario, std::string const& pattern);

/// When a function started in a window, when it operated after that, and when it fell back without; seconds.
struct FunctionCourse {
    double start_s{0};
    std::optional<double> operate_s, drop_s;
};
[[nodiscard]] std::optional<FunctionCourse> course_of(SignalStore const& signals, std::string const& relay,
                                                      std::string const& function, double from_s, double to_s);

} // namespace gridspace::launcher

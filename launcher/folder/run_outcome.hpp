// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/lateness.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// How the run went; completes manifest.json.
struct RunOutcome {
    int exit_code{0};
    std::string cause, remedy;
    double wall_s{0};       ///< from the start of the simulator's clock to its end
    double total_wall_s{0}; ///< of everything
    double simulated_s{0};
    std::uint64_t overruns{0};
    std::optional<Lateness::Summary> ticks; ///< how late they were, in real time
    struct ProcessEnd {
        std::string process, how;
        int code{0};
        double cpu_s{0}; ///< user and system time
    };
    std::vector<ProcessEnd> ends;
};

} // namespace gridspace::launcher

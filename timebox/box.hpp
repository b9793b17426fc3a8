// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::timebox {

struct BoxOptions {
    std::vector<std::string> command; ///< searched for in PATH
    std::uint64_t seed{1};            ///< of every random number that the kernel would give
    std::int64_t epoch_unix_s{0};     ///< what CLOCK_REALTIME shows at the start
    std::optional<std::int64_t> until_ns;
    double patience_s{60}; ///< of real time, that a program may compute without a call
    /// A call that was held: simulated time at which it goes on, s; number of the thread; name; how long, simulated, s.
    std::function<void(double, int, char const*, double)> on_held;
};

struct BoxReport {
    int exit_code{0}; ///< as a shell has it: 128 + n after signal n
    bool until_reached{false};
    std::int64_t simulated_ns{0};
    std::uint64_t held{0}, clock_reads{0};
    int threads{0};
    std::map<std::string, std::uint64_t> refused; ///< what cannot be had in simulated time, and how often it was tried
};

/// Runs a program, and all that it starts, in simulated time: its clocks stand still while it computes, and jump to the
/// next deadline when all of its threads wait. One thread runs at a time, in an order that does not depend on the
/// machine. Errors: it cannot be started; it computes without end; all wait for each other.
[[nodiscard]] Result<BoxReport> run_in_simulated_time(BoxOptions const& options);

} // namespace gridspace::timebox

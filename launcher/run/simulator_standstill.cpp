// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/simulator_standstill.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <ctime>
#include <fmt/format.h>

namespace gridspace::launcher {

std::optional<Error> SimulatorStandstill::look(std::string_view name, pid_t pid, double member_timeout_s,
                                               std::chrono::steady_clock::time_point now) {
    clockid_t clock{};
    timespec time{};
    if (::clock_getcpuclockid(pid, &clock) != 0 || ::clock_gettime(clock, &time) != 0) {
        return std::nullopt;
    }
    auto const used = std::chrono::seconds{time.tv_sec} + std::chrono::nanoseconds{time.tv_nsec};
    if (used != used_) {
        used_ = used;
        still_.restart(now);
    }
    // Its leases are renewed every second. Before they run out (10 s): the others would say that it is silent.
    double const patience_s = std::clamp(2 * member_timeout_s, 3.0, 8.0);
    if (still_.look(now).count() <= patience_s) {
        return std::nullopt;
    }
    return Error{ExitCode::stall,
                 fmt::format("the simulator '{}' stands still: it has used no processor time for {} s", name,
                             shortest(patience_s)),
                 "has somebody stopped it (SIGSTOP, a debugger)?"};
}

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/waited_time.hpp"

#include <chrono>
#include <optional>
#include <string_view>
#include <sys/types.h>

namespace gridspace::launcher {

/// Finds a simulator that stands still. It names everybody who stalls but itself. A living one always uses some
/// processor time, if only for its leases, however long its step or its wait for the next tick is; a stopped or frozen
/// one uses none.
class SimulatorStandstill {
  public:
    /// Looks at process `pid`, called often. The error once it has used no processor time for as long as members have
    /// patience with each other, but before its leases run out.
    [[nodiscard]] std::optional<Error> look(std::string_view name, pid_t pid, double member_timeout_s,
                                            std::chrono::steady_clock::time_point now);

  private:
    std::chrono::nanoseconds used_{-1};
    WaitedTime still_;
};

} // namespace gridspace::launcher

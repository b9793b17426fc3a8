// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/app/live_run.hpp"

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace gridspace::monitor {

/// Follows what the processes of a run use of this machine. The launcher notes the identifiers of those that it has
/// started here; a process on a board, or one that somebody else has started, has none, and nothing is said of it.
class ProcessUses {
  public:
    explicit ProcessUses(RunPlan const& plan);
    /// Looks again, about once a second; `live.use` says what was found.
    void follow(LiveRun& live, std::chrono::steady_clock::time_point now);

  private:
    struct Followed {
        std::string name;
        std::filesystem::path pid_file;
        pid_t pid{0};
        double cpu_s{0};
        std::chrono::steady_clock::time_point at;
    };
    static std::optional<ProcessUse> look(Followed& process, std::chrono::steady_clock::time_point now);
    std::vector<Followed> followed_;
    std::chrono::steady_clock::time_point next_{};
};

/// Processor time that a process of this machine has used so far, in seconds; nothing when there is none.
[[nodiscard]] std::optional<double> processor_s_of(pid_t pid);
/// What it has in memory, in octets; nothing when there is none.
[[nodiscard]] std::optional<std::uint64_t> memory_of(pid_t pid);

} // namespace gridspace::monitor

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/unique_fd.hpp"

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace gridspace::launcher {

/// Commands that run at once, each on processors of its own as long as there are enough: the processes of a lockstep
/// run wait for each other, and wake each other up faster on one processor than across two.
class RunPool {
  public:
    explicit RunPool(std::size_t jobs);
    RunPool(RunPool const&) = delete;
    RunPool& operator=(RunPool const&) = delete;
    ~RunPool(); ///< ends at once what still runs

    [[nodiscard]] bool has_room() const;
    [[nodiscard]] std::size_t running() const;

    /// Starts a command; `task` names it. Its output goes to `output`, and it dies with this process.
    [[nodiscard]] Result<void> start(std::size_t task, std::vector<std::string> const& command,
                                     std::filesystem::path const& output);

    struct Ended {
        std::size_t task{0};
        int exit{0}; ///< 128 and the signal for one that was killed
        double wall_s{0};
    };
    /// Waits for an end, at most so long and no longer than until `wake` can be read.
    [[nodiscard]] std::optional<Ended> wait(std::chrono::milliseconds timeout, int wake);

    /// Asks all to end, as Ctrl-C would.
    void interrupt() const;

  private:
    struct Slot {
        std::vector<int> processors; ///< empty: all
        pid_t pid{-1};
        UniqueFd pidfd;
        std::size_t task{0};
        std::chrono::steady_clock::time_point begin;
    };
    std::vector<Slot> slots_;
};

/// The processors that this process may use.
[[nodiscard]] std::vector<int> usable_processors();

} // namespace gridspace::launcher

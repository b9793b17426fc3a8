// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "launcher/run/child.hpp"
#include "launcher/run/run_plan.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// A process of the plan in its present incarnation, as its supervisor sees it.
struct WatchedProcess {
    /// How an incarnation ended.
    struct End {
        int wait_status{0};
        double cpu_s{0}; ///< that it used, with its children

        [[nodiscard]] int code() const;   ///< as a shell says it: 128 and the signal for who was killed
        [[nodiscard]] int signal() const; ///< 0 where it was not killed
        [[nodiscard]] std::string text() const;
    };

    PlannedProcess plan;
    Child child;
    bool running{false};
    bool matched{false};         ///< it has found all that it exchanges samples with
    bool expected_to_die{false}; ///< killed by an event of the scenario
    bool paused{false};          ///< by an event of the scenario: it does not hear of the end
    bool asked_to_end{false};
    std::int64_t incarnation{0};
    std::string pending;                                             ///< status text without its line end yet
    std::optional<Error> reported;                                   ///< what it said before it ended
    std::optional<std::chrono::steady_clock::time_point> comes_back; ///< a monitor that has ended

    [[nodiscard]] bool only_looks() const { return plan.program == "gridspace-monitor"; }
    [[nodiscard]] bool is_external() const { return plan.run_on.kind == RunOn::Kind::external; }

    /// Starts it, and writes its process id next to its configuration, for the monitor.
    [[nodiscard]] Result<void> start(SpawnOptions const& options);
    /// The lines of its status that are whole by now. Closes the pipe at its end.
    [[nodiscard]] std::vector<std::string> read_status();
    /// Of a process that has ended: collects it. None where it has not.
    [[nodiscard]] std::optional<End> reap();

    /// Makes its configuration that of the next incarnation.
    void next_incarnation();
    /// The same for one that joins at `at_s` of simulated time, while `absent` are not there.
    void next_incarnation(double at_s, std::vector<std::string> const& absent);

  private:
    void write_config() const;
};

/// Collects whatever the children of a run's process 1 have left behind.
void reap_strays(std::vector<WatchedProcess> const& watched);

/// The stall that stopped ones cause: they answer nobody, and the first who misses them may be missed by others in
/// turn. None where nobody is stopped that should run.
[[nodiscard]] std::optional<Error> stopped_ones(std::vector<WatchedProcess> const& watched);

} // namespace gridspace::launcher

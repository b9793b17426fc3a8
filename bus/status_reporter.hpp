// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/lateness.hpp"
#include "common/line_output.hpp"
#include "common/result.hpp"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace {

/// Reports what the process is doing, as JSON lines on a file descriptor (the launcher's pipe).
/// Without one it does nothing. It never waits for who reads them: what does not go at once goes with the next line, of
/// progress only the newest. Thread-safe.
class StatusReporter {
  public:
    explicit StatusReporter(int fd = -1) : fd_{fd}, output_{fd} {}
    ~StatusReporter();
    StatusReporter(StatusReporter const&) = delete;
    StatusReporter& operator=(StatusReporter const&) = delete;
    [[nodiscard]] int fd() const { return fd_; } ///< -1: nobody listens; for a handler of signals
    void matched();                              ///< the process has found all that it exchanges samples with
    void ready();                                ///< of the simulator: all have
    void failed(Error const& error);
    /// Progress of the simulator. Cheap; sends at most ten times a second unless `now` is set.
    void progress(double time_s, double duration_s, std::uint64_t overruns, bool now = false);
    /// How late the simulator's ticks were, at the end of a run in real time.
    void lateness(Lateness::Summary const& ticks);
    void event(double time_s, std::string_view source, std::string_view kind, std::string_view text);
    /// "Between tick and tick, the launcher has to act." With `wait`, returns what it answers on standard input: lines
    /// like "drop ev1", "rejoin ev1" or "restarted ev1 2".
    [[nodiscard]] Result<std::vector<std::string>> hold(std::uint64_t index, bool wait);
    /// "A tick is done": when the launcher has asked for a pause, waits until it says "continue" or "step N". Meanwhile
    /// nobody works, and no deadline runs. Returns early when `stop` is set; how long it has waited.
    std::chrono::steady_clock::duration pause_if_asked(double time_s, std::atomic<bool> const& stop);
    /// "My user wants this": pause, continue, "step 3" or stop, from the monitor.
    void control(std::string_view action);

  private:
    void send(std::string line, bool only_the_newest = false);
    void go_on(); ///< with what could not be sent at once
    /// A line of standard input, or nothing within `patience`. `input_ended_` is set when there will be no more.
    [[nodiscard]] std::optional<std::string> read_line(std::chrono::milliseconds patience);
    void take_pause(std::string const& line);
    int fd_;
    std::mutex mutex_;
    LineOutput output_; // under the mutex
    std::chrono::steady_clock::time_point last_progress_;
    std::string input_; // of standard input, beyond the lines that were taken
    bool input_ended_{false}, paused_{false};
    std::uint64_t steps_left_{0};
};

} // namespace gridspace

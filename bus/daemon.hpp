// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node.hpp"
#include "bus/node_config.hpp"
#include "common/config/fields.hpp"
#include "common/lateness.hpp"
#include "common/line_output.hpp"
#include "common/program/declaration.hpp"
#include "common/result.hpp"

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

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
    void ready();
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

/// What a daemon gets to run with.
struct DaemonRun {
    bus::NodeConfig bus;
    StatusReporter& status;
    /// `stop` is called once, from another thread, when the process is asked to end (SIGINT, SIGTERM).
    std::function<void(std::function<void()> stop)> on_stop;
};

/// A program of Gridspace: one life for all of them: parse -> check -> prepare -> start -> run -> stop.
struct Daemon {
    std::string_view program;                               ///< "gridspace-ev"
    std::string_view description;                           ///< one line
    std::function<void(config::Fields&)> describe_settings; ///< keys of `settings:`
    std::function<void(config::Diagnostics&)> check;        ///< beyond single keys; may be empty
    std::function<Result<void>(DaemonRun&)> run;
    bool joins_always{true}; ///< false: it may look at files instead, and then needs no QoS profiles
    std::function<program::Declaration()> declaration{}; ///< for --describe; without it the settings are what is known
    bool is_ours{true}; ///< false: somebody else's code, which may start programs and open raw sockets
};

/// The main function of every daemon: options --config FILE, --check, --describe, --log-level, --status-fd, --version,
/// --help. Signals are handled before anything else; errors are printed once; the exit code is from
/// common/exit_code.hpp. One of ours ends in it; who is not gets the exit code back.
int run_daemon(Daemon const& daemon, int argc, char** argv);

/// Joins the bus, hands the node to `body` and waits for nothing else: the part that most daemons share.
[[nodiscard]] Result<void> run_on_bus(DaemonRun& run, std::function<Result<void>(bus::Node&)> const& body);

} // namespace gridspace

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node.hpp"
#include "bus/node_config.hpp"
#include "bus/status_reporter.hpp"
#include "common/config/fields.hpp"
#include "common/program/declaration.hpp"
#include "common/result.hpp"

#include <functional>
#include <string_view>

namespace gridspace {

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

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/app/access_config.hpp"
#include "monitor/diagram/grid.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace gridspace::monitor {

/// The settings of the monitor about its run, its network included. A monitor on a foreign bus has
/// none.
struct RunPlan : diagram::Grid {
    std::string scenario, mode, speed;
    double duration_s{0};         ///< 0: not known
    std::filesystem::path events; ///< events.ndjson of the run, which the launcher writes
    std::filesystem::path graph;  ///< graph.json of the run: the monitor keeps what it has seen, for the recorded run

    struct Process {
        std::string name, program, host;
        std::filesystem::path pid_file; ///< of one that the launcher has started on this machine
    };
    std::vector<Process> processes;

    /// A process publishes or subscribes raw frames.
    struct Wire {
        std::string process, stream, kind, link;
        bool sends{false};
    };
    std::vector<Wire> wires;

    /// What the scenario expects; whether it held is judged when the run has ended.
    struct Expectation {
        std::string name, rule, accepted, unit;
        bool advisory{false};
    };
    std::vector<Expectation> expectations;
};

/// Settings of gridspace-monitor.
struct MonitorConfig : AccessConfig {
    std::filesystem::path recording;     ///< data.mcap of a finished run; then no bus is joined
    std::filesystem::path control_token; ///< file with the secret of whoever may control the run; none: nobody may
    std::map<std::string, std::filesystem::path> types; ///< the IDL of the types of the scenario's own programs
    RunPlan run;
};

void describe(config::Fields& f, MonitorConfig& config);

} // namespace gridspace::monitor

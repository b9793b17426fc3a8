// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/run/ssh_board.hpp"
#include "launcher/scenario/addresses.hpp"
#include "launcher/scenario/bumps.hpp"
#include "launcher/scenario/run_on.hpp"
#include "launcher/scenario/scenario.hpp"

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// One process to start.
struct PlannedProcess {
    std::string name, program, host;
    std::filesystem::path config_file; ///< in the run folder
    config::Node config;               ///< what goes into it
    std::vector<std::string> command;
    std::map<std::string, std::string> environment;
    std::optional<std::int64_t> cpu;
    RunOn run_on;
    int fifo_priority{0}; ///< of SCHED_FIFO; 0: the system's usual scheduling
    std::filesystem::path log_file;
    bool is_simulator{false};
    bool is_foreign{false};  ///< somebody else's program
    bool has_status{true};   ///< takes --status-fd
    bool is_member{false};   ///< its end before the run's is a failure, also with exit code 0
    bool is_observer{false}; ///< ends when asked to
    bool is_guest{false};    ///< its host's interfaces are handed over to it
    std::string ready_says;  ///< it is ready when its output holds this; empty: once it is started
    double ready_within_s{0};
    std::size_t acquaintances{0};      ///< processes with which it exchanges samples or acknowledgements
    std::string listen;                ///< address to serve on; the launcher opens the socket
    std::string interface;             ///< a real one, which is taken into its host for the run
    std::vector<std::string> networks; ///< hosts into whose networks it looks
    /// All that it keeps of this process's capabilities; none given: everything, which emulators and ssh need that plug
    /// a board into the network.
    std::optional<std::uint64_t> capabilities;
};

/// Something that the launcher does to a process between two ticks.
struct ProcessAction {
    enum class Kind { kill, pause, resume, restart } kind{Kind::kill};
    std::string event, process;
    double at_s{0};
};

/// Everything that a run needs, ready to be carried out.
struct RunPlan {
    std::string scenario;
    std::filesystem::path folder;
    bool namespaces{true};
    std::vector<std::string> hosts;
    std::vector<Link> links;
    std::vector<Port> ports;
    std::vector<PlacedBump> bumps;
    std::set<std::string> boxed_ip_links; ///< on which programs in simulated time speak IP
    int outer_network{-1}; ///< the network namespace in which `gridspace run` was called, where real interfaces are
    std::vector<PlannedProcess> processes;         ///< the simulator last
    std::vector<std::vector<ProcessAction>> holds; ///< by index of the simulator's hold
    double duration_s{0};
    bool lockstep{true};
    std::size_t board_places{0}; ///< members and simulator, whose clock goes through shared memory; 0: over DDS
    bool allow_control{false};   ///< pause, continue, step and stop through the monitor
    double start_timeout_s{30}, member_timeout_s{10};
    std::string scheduling; ///< in real time: what the processes run under, and why; for the manifest and the report
    std::string processors; ///< "awake", or why they may sleep; for the same
};

struct PlanOptions {
    std::filesystem::path folder; ///< of the run; absolute
    bool namespaces{true};        ///< false: everything on the loopback interface
    int domain{0};                ///< first of two DDS domains for the run (without namespaces)
    std::string log_level{"info"};
    bool allow_control{false}; ///< the monitor is given the token that RUN/control.token holds
    BoardBundles boards{};     ///< what prepare_boards() made of the boards
    std::string processors{};  ///< as in RunPlan
};

/// Real time: takes SCHED_FIFO from all processes where the system does not permit it, and says so in `scheduling`.
void settle_scheduling(RunPlan& plan);

[[nodiscard]] RunPlan make_plan(Scenario const& scenario, PlanOptions const& options);

/// The plan as text, for --dry-run.
[[nodiscard]] std::string to_text(RunPlan const& plan);

} // namespace gridspace::launcher

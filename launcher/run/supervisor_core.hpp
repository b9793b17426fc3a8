// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/unique_fd.hpp"
#include "launcher/run/run_news.hpp"
#include "launcher/run/run_plan.hpp"
#include "launcher/run/simulator_standstill.hpp"
#include "launcher/run/virtual_network.hpp"
#include "launcher/run/watched_process.hpp"

#include <chrono>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gridspace::launcher {

/// The inside of supervise(): the processes of a run, and how the run goes.
class Supervisor {
  public:
    Supervisor(RunPlan const& plan, int channel, std::map<std::string, UniqueFd> const& listen_fds);
    int run();

  private:
    using Clock = std::chrono::steady_clock;

    // Their lives: supervisor.cpp.
    /// Who looks into the networks of other hosts finds them by descriptors of this process, which is process 1.
    void tell_networks();
    Result<void> start(WatchedProcess& w);
    /// First those whose readiness is waited for: the others wait for each other, with a deadline.
    Result<void> start_all();
    /// Some at a time (GradualStart).
    Result<void> start_gradually(std::vector<WatchedProcess*> processes);
    /// Of somebody's own program that says so in its output.
    void wait_until_ready(WatchedProcess const& w);
    /// The run is over: it failed, was stopped, or the simulator has finished and everybody who follows it has too.
    bool over();
    /// How long the members may take to end after the simulator, or the simulator after the first of them. None without
    /// deadlines.
    [[nodiscard]] std::optional<std::chrono::duration<double>> end_patience() const;
    std::vector<WatchedProcess>::iterator simulator();
    void watch_simulator(Clock::time_point now);
    void bring_back_monitor();
    void step();
    /// Ends what still runs: a request, two seconds (ten for who has to finish a recording on a slow disk), then force.
    void end_all();

    // What they and the user say, how they end, and what of that is a failure: supervisor_reports.cpp.
    void read_channel();
    void read_status(WatchedProcess& w);
    void on_status(WatchedProcess& w, nlohmann::ordered_json& status);
    /// What a user asks for in the dashboard. Only the monitor may, and only when the run was started so.
    void control(WatchedProcess const& from, std::string const& action);
    void reap(WatchedProcess& w);
    /// Of a process that nobody has asked to end.
    void judge_end(WatchedProcess& w, WatchedProcess::End const& end);
    [[nodiscard]] Error suspicion() const;
    void fail_with(Error error);

    // What the timeline does to them: supervisor_actions.cpp.
    /// Carries out what is due at a held tick, then lets the simulator go on.
    void strike(WatchedProcess& simulator, std::size_t index);
    /// Adds to `answer`, the simulator's orders; false when that has failed.
    bool act(ProcessAction const& action, std::string& answer);
    void kill_and_reap(WatchedProcess& w);
    bool restart(WatchedProcess& w, double at_s);

    /// Before the monitor is started again: one that fails at once is no load.
    static constexpr std::chrono::seconds kPauseOfMonitor{1};

    RunPlan const& plan_;
    int channel_;
    RunNews news_; ///< to the channel
    std::map<std::string, UniqueFd> const& listen_fds_;
    VirtualNetwork network_;
    Result<UniqueFd> board_{UniqueFd{}};
    std::vector<WatchedProcess> watched_;
    std::optional<Error> failure_;
    std::optional<Clock::time_point> simulator_done_;
    SimulatorStandstill standstill_;
    std::optional<std::pair<Clock::time_point, std::string>> suspect_; ///< a member that has ended, and when
};

} // namespace gridspace::launcher

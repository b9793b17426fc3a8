// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/run.hpp"

#include "common/text.hpp"
#include "common/unique_fd.hpp"
#include "launcher/folder/event_log.hpp"
#include "launcher/run/domain_lock.hpp"
#include "launcher/run/emulation.hpp"
#include "launcher/run/listening.hpp"
#include "launcher/run/live_verdict.hpp"
#include "launcher/run/monitor_client.hpp"
#include "launcher/run/namespaces.hpp"
#include "launcher/run/secured_run.hpp"
#include "launcher/run/supervisor.hpp"
#include "launcher/scenario/wire_use.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

/// Follows the supervisor of a run until it is gone.
class Follower {
  public:
    Follower(RunPlan const& plan, Progress& progress, EventLog& events)
        : plan_{plan}, progress_{progress}, events_{events} {}

    RunOutcome follow(pid_t supervisor, int channel, InterruptWatch& interrupts) {
        UniqueFd const pidfd{static_cast<int>(::syscall(SYS_pidfd_open, supervisor, 0))};
        int asked = 0;
        bool gone = false;
        while (!gone) {
            pollfd fds[] = {{channel, POLLIN, 0},
                            {pidfd.get(), POLLIN, 0},
                            {interrupts.fd(), POLLIN, 0},
                            {progress_.waits_for(), POLLOUT, 0}};
            ::poll(fds, 4, 1000);
            progress_.flush();
            if (fds[0].revents != 0) {
                read(channel);
            }
            if (fds[2].revents != 0) {
                asked += interrupts.take();
                if (asked == 1) {
                    progress_.note("stopping (once more: at once)");
                    [[maybe_unused]] auto const sent = ::write(channel, "stop", 4);
                } else if (asked > 1) {
                    ::kill(supervisor, SIGKILL); // its namespaces go with it
                }
            }
            gone = fds[1].revents != 0;
        }
        while (read(channel)) {
        }
        int status = 0;
        ::waitpid(supervisor, &status, 0);
        progress_.finish();
        if (!over_) {
            outcome_.exit_code =
                asked > 1 ? static_cast<int>(ExitCode::interrupted) : static_cast<int>(ExitCode::child_died);
            outcome_.cause = asked > 1 ? "stopped at once" : "the supervisor of the run died, and everything with it";
        }
        if (started_) {
            outcome_.wall_s = std::chrono::duration<double>(last_progress_ - clock_started_).count();
        }
        outcome_.simulated_s = time_s_;
        return outcome_;
    }

  private:
    /// False when nothing more can come.
    bool read(int channel) {
        char buffer[65536];
        ssize_t const size = ::recv(channel, buffer, sizeof buffer, MSG_DONTWAIT);
        if (size <= 0) {
            return false;
        }
        pending_.append(buffer, static_cast<std::size_t>(size));
        for (std::size_t end = 0; (end = pending_.find('\n')) != std::string::npos;) {
            Json const line = Json::parse(pending_.substr(0, end), nullptr, false);
            pending_.erase(0, end + 1);
            if (line.is_object()) {
                on_line(line);
            }
        }
        return true;
    }

    void on_line(Json const& line) {
        std::string const kind = line.value("kind", ""), process = line.value("process", "");
        if (kind == "status") {
            on_status(process, line);
        } else if (kind == "exit") {
            std::erase_if(outcome_.ends, [&](auto const& e) { return e.process == process; });
            outcome_.ends.push_back({process, line.value("how", ""), line.value("code", 0), line.value("cpu_s", 0.0)});
            if (line.value("code", 0) != 0 && !line.value("expected", false)) { // a planned kill is an event already
                events_.write(time_s_, process, "exit", line.value("how", ""));
            }
        } else if (kind == "returned") {
            events_.write(time_s_, process, "started_again",
                          fmt::format("incarnation {}; the run went on without it", line.value("incarnation", 0)));
        } else if (kind == "process_action") {
            std::string const text = fmt::format("{} {}", line.value("process", ""), line.value("what", ""));
            events_.write(line.value("time_s", 0.0), "launcher", line.value("event", ""), text);
            progress_.event(line.value("time_s", 0.0), "launcher", line.value("event", ""), text);
        } else if (kind == "failed") {
            bool const stopped = line.value("code", 0) == static_cast<int>(ExitCode::interrupted);
            events_.write(time_s_, "launcher", stopped ? "run_stopped" : "run_failed", line.value("cause", ""));
        } else if (kind == "over") {
            over_ = true;
            outcome_.exit_code = line.value("code", 0);
            outcome_.cause = line.value("cause", "");
            outcome_.remedy = line.value("remedy", "");
            if (auto const left_out = line.value("left_out", std::uint64_t{0}); left_out > 0) {
                std::string const text =
                    fmt::format("{} lines about the run are left out: this process did not take them", left_out);
                events_.write(time_s_, "launcher", "left_out", text);
                progress_.note(text);
            }
        }
    }

    /// In real time nobody waits for what somebody else starts, and nobody knows whether it is there.
    [[nodiscard]] std::string ready_text() const {
        std::vector<std::string> others;
        for (PlannedProcess const& process : plan_.processes) {
            if (!plan_.lockstep && process.run_on.kind == RunOn::Kind::external) {
                others.push_back(process.name);
            }
        }
        return others.empty() ? fmt::format("all {} processes are ready", plan_.processes.size())
                              : fmt::format("all {} processes that are started here are ready; {} may join at any time",
                                            plan_.processes.size() - others.size(), join(others, ", "));
    }

    /// When the process wrote it.
    static Clock::time_point instant_of(Json const& line) {
        auto const at_ns = line.value("at_ns", std::int64_t{0});
        return at_ns == 0 ? Clock::now() : Clock::time_point{std::chrono::nanoseconds{at_ns}};
    }

    void on_status(std::string const& process, Json const& line) {
        std::string const status = line.value("status", "");
        if (status == "ready") {
            progress_.note(ready_text());
            clock_started_ = last_progress_ = instant_of(line);
            started_ = true;
        } else if (status == "progress") {
            time_s_ = line.value("time_s", 0.0);
            last_progress_ = instant_of(line);
            outcome_.overruns = line.value("overruns", std::uint64_t{0});
            progress_.update(time_s_, outcome_.overruns);
        } else if (status == "event") {
            events_.write(line.value("time_s", 0.0), line.value("source", process), line.value("event", ""),
                          line.value("text", ""));
            progress_.event(line.value("time_s", 0.0), line.value("source", process), line.value("event", ""),
                            line.value("text", ""));
        } else if (status == "paused" || status == "resumed") {
            time_s_ = line.value("time_s", 0.0);
            events_.write(time_s_, "launcher", status, fmt::format("the run is {}", status));
            progress_.note(fmt::format("the run is {} at {} s", status, time_s_));
        } else if (status == "serving") {
            progress_.note(fmt::format("{}: {}", process, line.value("url", "")));
        }
    }

    RunPlan const& plan_;
    Progress& progress_;
    EventLog& events_;
    RunOutcome outcome_;
    std::string pending_;
    bool over_{false}, started_{false};
    double time_s_{0};
    Clock::time_point clock_started_, last_progress_;
};

/// A text of the settings of a process; empty when it is not there.
std::string setting(PlannedProcess const& process, std::string_view key) {
    config::Node const* const settings = process.config.find("settings");
    config::Node const* const value = settings == nullptr ? nullptr : settings->find(key);
    return value == nullptr ? std::string{} : value->text;
}

bool has_boards(Scenario const& scenario) {
    return std::any_of(scenario.processes.begin(), scenario.processes.end(), [](Process const& process) {
        return parse_run_on(process.run_on).value_or(RunOn{}).kind == RunOn::Kind::ssh;
    });
}

} // namespace

Result<void> check_isolation(Scenario const& scenario, bool namespaces) {
    if (!namespaces && has_raw_frames(scenario)) {
        return fail(ExitCode::usage,
                    "this scenario exchanges raw frames, and those need hosts with interfaces of their own",
                    "run it without --no-namespaces");
    }
    if (!namespaces && has_boards(scenario)) {
        return fail(ExitCode::usage, "this scenario runs processes on boards, and those take the place of hosts",
                    "run it without --no-namespaces");
    }
    return {};
}

Result<FinishedRun> run_scenario(Scenario const& scenario, RunOptions const& options, InterruptWatch& interrupts) {
    auto const begin = Clock::now();
    if (auto ok = check_isolation(scenario, options.namespaces); !ok) {
        return std::unexpected{ok.error()};
    }
    if (auto ok = check_emulators(scenario); !ok) {
        return std::unexpected{ok.error()};
    }
    for (Process const& process : scenario.processes) {
        bool const allowed = process.interface == options.allow_attacks_on;
        if (process.program.name == "gridspace-attacker" && !process.interface.empty() && !allowed) {
            return fail(
                ExitCode::usage,
                fmt::format("process '{}' would attack on '{}', which is a real network", process.name.name,
                            process.interface),
                fmt::format("forged frames can operate real switchgear; if that is meant: --allow-attacks-on {}",
                            process.interface));
        }
    }
    Progress progress{options.style, scenario.name, scenario.simulation.duration().to_double()};
    bool const with_boards = has_boards(scenario);
    auto boards = prepare_boards(scenario, [&](std::string_view text) { progress.note(text); });
    if (!boards) {
        return std::unexpected{boards.error()};
    }
    auto folder = make_run_folder(scenario.name, options.parent, options.out);
    if (!folder) {
        return std::unexpected{folder.error()};
    }
    bool const root = ::geteuid() == 0;
    auto events = EventLog::create(*folder / "events.ndjson");
    if (!events) {
        return std::unexpected{events.error()};
    }

    PlanOptions plan_options{*folder,           options.namespaces,    0,
                             options.log_level, options.allow_control, std::move(*boards)};
    if (options.allow_control) {
        if (auto ok = write_control_token(*folder); !ok) {
            return std::unexpected{ok.error()};
        }
    }
    RunPlan plan = make_plan(scenario, plan_options);
    settle_scheduling(plan);
    if (plan.scheduling.starts_with("SCHED_OTHER:")) {
        progress.note("note: " + plan.scheduling);
    }
    UniqueFd outer;
    if (std::any_of(plan.processes.begin(), plan.processes.end(),
                    [](PlannedProcess const& p) { return !p.interface.empty(); })) {
        if (!root) {
            return fail(ExitCode::environment,
                        "the scenario takes real interfaces into its hosts, and only root can do that",
                        "run it as root, or without `interface:`");
        }
        outer.reset(::open("/proc/self/ns/net", O_RDONLY | O_CLOEXEC));
        plan.outer_network = outer.get();
    }
    if ((with_boards ||
         std::any_of(plan.ports.begin(), plan.ports.end(), [](Port const& port) { return !port.plug.empty(); })) &&
        !outer) {
        if (!root) {
            return fail(ExitCode::environment,
                        "the scenario plugs real interfaces into its switches, and only root can do that",
                        "run it as root, or without `plugs:`");
        }
        outer.reset(::open("/proc/self/ns/net", O_RDONLY | O_CLOEXEC));
        plan.outer_network = outer.get();
    }
    for (PlannedProcess& process : plan.processes) {
        if (process.run_on.kind == RunOn::Kind::ssh) { // of the supervisor, which is process 1 where this is read
            process.environment["GRIDSPACE_OUTER_NETWORK"] = fmt::format("/proc/1/fd/{}", outer.get());
        }
    }
    std::map<std::string, UniqueFd> listen_fds;
    UniqueFd monitor_note; // locked while the run is under way
    for (PlannedProcess& process : plan.processes) {
        if (!process.listen.empty()) {
            auto socket = open_listening(process.listen);
            if (!socket) {
                return std::unexpected{socket.error()};
            }
            listen_fds[process.name] = std::move(socket->fd);
            MonitorAddress const monitor{socket->address, setting(process, "tls_cert"), setting(process, "token_file")};
            progress.note(fmt::format("{}: {}", process.name, monitor.url()));
            auto noted = note_monitor(*folder, monitor); // for `gridspace graph` and `topic`
            if (!noted) {
                return std::unexpected{noted.error()};
            }
            monitor_note = std::move(*noted);
        }
    }
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
        return fail(ExitCode::environment, fmt::format("no socket: {}", std::strerror(errno)));
    }
    UniqueFd channel{ends[0]}, supervisors_end{ends[1]};
    progress.note(fmt::format("run folder: {}", folder->string()));
    for (PlannedProcess const& process : plan.processes) {
        if (process.run_on.kind == RunOn::Kind::external) {
            progress.note(fmt::format("{}: is to be started by somebody else, with {}", process.name,
                                      process.config_file.string()));
        }
    }

    std::optional<DomainLock> domains;
    Result<pid_t> supervisor = fail(ExitCode::environment, "");
    auto const body = [&] {
        channel.reset();
        return supervise(plan, supervisors_end.get(), listen_fds);
    };
    auto const write = [&](std::vector<int> const& bus_domains) -> Result<void> {
        auto ok = secure(scenario, plan, bus_domains, std::time(nullptr));
        return ok ? write_inputs(scenario, plan, root) : ok;
    };
    if (options.namespaces) {
        if (auto ok = write({0, 1}); !ok) {
            return std::unexpected{ok.error()};
        }
        supervisor = start_in_namespaces(body);
    }
    if (!supervisor && !with_boards && (!options.namespaces || !has_raw_frames(scenario))) {
        if (options.namespaces) {
            progress.note(
                fmt::format("note: {}; running on the loopback interface instead", describe(supervisor.error())));
        }
        auto taken = DomainLock::take();
        if (!taken) {
            return std::unexpected{taken.error()};
        }
        domains.emplace(std::move(*taken));
        plan_options.namespaces = false;
        plan_options.domain = domains->first();
        plan = make_plan(scenario, plan_options);
        settle_scheduling(plan);
        if (auto ok = write({domains->first(), domains->first() + 1}); !ok) {
            return std::unexpected{ok.error()};
        }
        supervisor = start_without_namespaces(body);
    }
    supervisors_end.reset();
    listen_fds.clear();
    if (!supervisor) {
        return std::unexpected{supervisor.error()};
    }
    FinishedRun finished;
    finished.folder = *folder;
    {
        LiveVerdict const so_far{scenario, *folder};
        finished.outcome = Follower{plan, progress, *events}.follow(*supervisor, channel.get(), interrupts);
    }
    channel.reset();
    forget_run_keys(*folder);
    finished.unread = progress.take_unread();
    finished.outcome.total_wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
    if (auto ok = write_outcome(*folder, finished.outcome);
        !ok) { // a full disk: how the run went is to be said all the same
        finished.unwritten = ok.error();
    }
    return finished;
}

} // namespace gridspace::launcher

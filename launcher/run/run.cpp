// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/run.hpp"

#include "common/realtime.hpp"
#include "common/text.hpp"
#include "common/unique_fd.hpp"
#include "launcher/folder/event_log.hpp"
#include "launcher/run/domain_lock.hpp"
#include "launcher/run/emulation.hpp"
#include "launcher/run/follower.hpp"
#include "launcher/run/kernel_drops.hpp"
#include "launcher/run/listening.hpp"
#include "launcher/run/live_verdict.hpp"
#include "launcher/run/monitor_client.hpp"
#include "launcher/run/namespaces.hpp"
#include "launcher/run/secured_run.hpp"
#include "launcher/run/supervisor.hpp"
#include "launcher/scenario/wire_use.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

using Clock = std::chrono::steady_clock;

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

/// Forged frames on a real network only where that was said.
Result<void> check_attacks(Scenario const& scenario, std::string const& allowed_on) {
    for (Process const& process : scenario.processes) {
        if (process.program.name == "gridspace-attacker" && !process.interface.empty() &&
            process.interface != allowed_on) {
            return fail(
                ExitCode::usage,
                fmt::format("process '{}' would attack on '{}', which is a real network", process.name.name,
                            process.interface),
                fmt::format("forged frames can operate real switchgear; if that is meant: --allow-attacks-on {}",
                            process.interface));
        }
    }
    return {};
}

/// The network in which real interfaces are, for a run that uses any, also those of boards; nothing for others.
Result<UniqueFd> open_outer_network(RunPlan const& plan, bool with_boards) {
    bool const takes = std::any_of(plan.processes.begin(), plan.processes.end(),
                                   [](PlannedProcess const& p) { return !p.interface.empty(); });
    bool const plugs =
        std::any_of(plan.ports.begin(), plan.ports.end(), [](Port const& port) { return !port.plug.empty(); });
    if (!takes && !plugs && !with_boards) {
        return UniqueFd{};
    }
    if (::geteuid() != 0) {
        return fail(
            ExitCode::environment,
            fmt::format("the scenario {}, and only root can do that",
                        takes ? "takes real interfaces into its hosts" : "plugs real interfaces into its switches"),
            takes ? "run it as root, or without `interface:`" : "run it as root, or without `plugs:`");
    }
    return UniqueFd{::open("/proc/self/ns/net", O_RDONLY | O_CLOEXEC)};
}

/// What a run listens on, opened before anybody starts.
struct Listening {
    std::map<std::string, UniqueFd> sockets; ///< by process
    UniqueFd monitor_note;                   ///< locked while the run is under way
};

Result<Listening> listen(RunPlan const& plan, std::filesystem::path const& folder, Progress& progress) {
    Listening out;
    for (PlannedProcess const& process : plan.processes) {
        if (process.listen.empty()) {
            continue;
        }
        auto socket = open_listening(process.listen);
        if (!socket) {
            return std::unexpected{socket.error()};
        }
        out.sockets[process.name] = std::move(socket->fd);
        MonitorAddress const monitor{socket->address, setting(process, "tls_cert"), setting(process, "token_file")};
        progress.note(fmt::format("{}: {}", process.name, monitor.url()));
        auto noted = note_monitor(folder, monitor); // for `gridspace graph` and `topic`
        if (!noted) {
            return std::unexpected{noted.error()};
        }
        out.monitor_note = std::move(*noted);
    }
    return out;
}

/// What speaks against the run, before anything of it is there.
Result<void> check_run(Scenario const& scenario, RunOptions const& options) {
    if (auto ok = check_isolation(scenario, options.namespaces); !ok) {
        return ok;
    }
    if (auto ok = check_emulators(scenario); !ok) {
        return ok;
    }
    return check_attacks(scenario, options.allow_attacks_on);
}

RunPlan make_settled_plan(Scenario const& scenario, PlanOptions const& options) {
    RunPlan plan = make_plan(scenario, options);
    settle_scheduling(plan);
    return plan;
}

void note_scheduling(RunPlan const& plan, Progress& progress) {
    if (plan.scheduling.starts_with("SCHED_OTHER:")) {
        progress.note("note: " + plan.scheduling);
    }
}

/// Whether processors may go to sleep between two ticks.
struct Awake {
    UniqueFd until_the_end; ///< none when they may
    std::string text;       ///< of the manifest and the report
};
Awake keep_awake(Scenario const& scenario) {
    bool const is_hurried = scenario.clock.mode == bus::ClockMode::realtime || scenario.clock.speed == 0;
    if (!is_hurried || !scenario.clock.awake) {
        return {{}, is_hurried ? "may sleep, as the scenario asks" : "may sleep: lockstep has a pace"};
    }
    auto kept = keep_processors_awake();
    return kept ? Awake{std::move(*kept), "awake"} : Awake{{}, "may sleep: " + kept.error().message};
}

void hand_over_outer_network(int outer_network, RunPlan& plan) {
    plan.outer_network = outer_network;
    for (PlannedProcess& process : plan.processes) {
        if (process.run_on.kind == RunOn::Kind::ssh) { // of the supervisor, which is process 1 where this is read
            process.environment["GRIDSPACE_OUTER_NETWORK"] = fmt::format("/proc/1/fd/{}", outer_network);
        }
    }
}

/// Between this process and the supervisor.
struct Channel {
    UniqueFd own_end, supervisors_end;
};

Result<Channel> open_channel() {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
        return fail(ExitCode::environment, fmt::format("no socket: {}", std::strerror(errno)));
    }
    return Channel{UniqueFd{ends[0]}, UniqueFd{ends[1]}};
}

void note_folder(RunPlan const& plan, Progress& progress) {
    progress.note(fmt::format("run folder: {}", plan.folder.string()));
    for (PlannedProcess const& process : plan.processes) {
        if (process.run_on.kind == RunOn::Kind::external) {
            progress.note(fmt::format("{}: is to be started by somebody else, with {}", process.name,
                                      process.config_file.string()));
        }
    }
}

/// All that the processes read. `bus_domains`: those of DDS that they meet in.
Result<void> write_secured_inputs(Scenario const& scenario, RunPlan& plan, std::vector<int> const& bus_domains) {
    auto ok = secure(scenario, plan, bus_domains, std::time(nullptr));
    return ok ? write_inputs(scenario, plan, ::geteuid() == 0) : ok;
}

struct StartedRun {
    pid_t supervisor{0};
    std::optional<DomainLock> domains; ///< of a run on the loopback interface
};

/// The plan becomes one for the loopback interface.
Result<StartedRun> start_on_loopback(Scenario const& scenario, PlanOptions options, RunPlan& plan,
                                     std::function<int()> const& supervisor) {
    auto domains = DomainLock::take();
    if (!domains) {
        return std::unexpected{domains.error()};
    }
    options.namespaces = false;
    options.domain = domains->first();
    plan = make_settled_plan(scenario, options);
    if (auto ok = write_secured_inputs(scenario, plan, {domains->first(), domains->first() + 1}); !ok) {
        return std::unexpected{ok.error()};
    }
    auto const started = start_without_namespaces(supervisor);
    if (!started) {
        return std::unexpected{started.error()};
    }
    return StartedRun{*started, std::move(*domains)};
}

/// In namespaces; where there are none, on the loopback interface, if the scenario can do with it.
Result<StartedRun> start(Scenario const& scenario, PlanOptions const& options, RunPlan& plan,
                         std::function<int()> const& supervisor, Progress& progress) {
    if (options.namespaces) {
        if (auto ok = write_secured_inputs(scenario, plan, {0, 1}); !ok) {
            return std::unexpected{ok.error()};
        }
        auto const started = start_in_namespaces(supervisor);
        if (started) {
            return StartedRun{*started, std::nullopt};
        }
        if (has_boards(scenario) || has_raw_frames(scenario)) {
            return std::unexpected{started.error()};
        }
        progress.note(fmt::format("note: {}; running on the loopback interface instead", describe(started.error())));
    }
    return start_on_loopback(scenario, options, plan, supervisor);
}

FinishedRun follow_to_the_end(Scenario const& scenario, RunPlan const& plan, pid_t supervisor, UniqueFd channel,
                              Progress& progress, EventLog& events, InterruptWatch& interrupts) {
    FinishedRun finished;
    finished.folder = plan.folder;
    std::uint64_t const dropped_before = kernel_drops();
    {
        LiveVerdict const so_far{scenario, plan.folder};
        finished.outcome = follow(plan, supervisor, channel.get(), progress, events, interrupts);
    }
    std::uint64_t const dropped = kernel_drops(); // of 32 bits: it may have begun again
    if (auto const lost = lost_in_kernel(dropped - std::min(dropped, dropped_before), kernel_backlog()); lost) {
        events.write(finished.outcome.simulated_s, "launcher", "kernel_dropped_frames", describe(*lost));
        progress.note("note: " + describe(*lost));
    }
    channel.reset();
    forget_run_keys(plan.folder);
    finished.unread = progress.take_unread();
    return finished;
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
    if (auto ok = check_run(scenario, options); !ok) {
        return std::unexpected{ok.error()};
    }
    Progress progress{options.style, scenario.name, scenario.simulation.duration().to_double()};
    auto boards = prepare_boards(scenario, [&](std::string_view text) { progress.note(text); });
    if (!boards) {
        return std::unexpected{boards.error()};
    }
    auto folder = make_run_folder(scenario.name, options.parent, options.out);
    if (!folder) {
        return std::unexpected{folder.error()};
    }
    auto events = EventLog::create(*folder / "events.ndjson");
    if (!events) {
        return std::unexpected{events.error()};
    }
    if (options.allow_control) {
        if (auto ok = write_control_token(*folder); !ok) {
            return std::unexpected{ok.error()};
        }
    }
    Awake const awake = keep_awake(scenario);
    PlanOptions const plan_options{
        *folder, options.namespaces, 0, options.log_level, options.allow_control, std::move(*boards), awake.text};
    RunPlan plan = make_settled_plan(scenario, plan_options);
    note_scheduling(plan, progress);
    auto const outer = open_outer_network(plan, has_boards(scenario));
    if (!outer) {
        return std::unexpected{outer.error()};
    }
    hand_over_outer_network(outer->get(), plan);
    auto listening = listen(plan, *folder, progress);
    if (!listening) {
        return std::unexpected{listening.error()};
    }
    auto channel = open_channel();
    if (!channel) {
        return std::unexpected{channel.error()};
    }
    note_folder(plan, progress);
    auto const supervisor = [&] {
        channel->own_end.reset();
        return supervise(plan, channel->supervisors_end.get(), listening->sockets);
    };
    auto const started = start(scenario, plan_options, plan, supervisor, progress);
    if (!started) {
        return std::unexpected{started.error()};
    }
    channel->supervisors_end.reset();
    listening->sockets.clear();
    FinishedRun finished = follow_to_the_end(scenario, plan, started->supervisor, std::move(channel->own_end), progress,
                                             *events, interrupts);
    finished.outcome.total_wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
    if (auto ok = write_outcome(*folder, finished.outcome); !ok) {
        // A full disk: how the run went is to be said all the same.
        finished.unwritten = ok.error();
    }
    return finished;
}

} // namespace gridspace::launcher

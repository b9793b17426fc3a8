// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/run.hpp"

#include "common/text.hpp"
#include "common/unique_fd.hpp"
#include "launcher/folder/event_log.hpp"
#include "launcher/run/domain_lock.hpp"
#include "launcher/run/emulation.hpp"
#include "launcher/run/follower.hpp"
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
    if (auto ok = check_attacks(scenario, options.allow_attacks_on); !ok) {
        return std::unexpected{ok.error()};
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
    auto const outer = open_outer_network(plan, with_boards);
    if (!outer) {
        return std::unexpected{outer.error()};
    }
    plan.outer_network = outer->get();
    for (PlannedProcess& process : plan.processes) {
        if (process.run_on.kind == RunOn::Kind::ssh) { // of the supervisor, which is process 1 where this is read
            process.environment["GRIDSPACE_OUTER_NETWORK"] = fmt::format("/proc/1/fd/{}", outer->get());
        }
    }
    auto listening = listen(plan, *folder, progress);
    if (!listening) {
        return std::unexpected{listening.error()};
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
        return supervise(plan, supervisors_end.get(), listening->sockets);
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
    listening->sockets.clear();
    if (!supervisor) {
        return std::unexpected{supervisor.error()};
    }
    FinishedRun finished;
    finished.folder = *folder;
    {
        LiveVerdict const so_far{scenario, *folder};
        finished.outcome = follow(plan, *supervisor, channel.get(), progress, *events, interrupts);
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

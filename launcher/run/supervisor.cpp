// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/supervisor.hpp"

#include "bus/board/board.hpp"
#include "common/text.hpp"
#include "common/waited_time.hpp"
#include "launcher/run/gradual_start.hpp"
#include "launcher/run/output_watch.hpp"
#include "launcher/run/supervisor_core.hpp"

#include <algorithm>
#include <csignal>
#include <fmt/format.h>
#include <functional>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <sys/resource.h>

namespace gridspace::launcher {
namespace {

using std::chrono::seconds;

/// Hundreds of hosts and processes need more descriptors than the 1024 that are usual. In real time: to lock memory
/// without CAP_IPC_LOCK, which the processes give up.
void raise_limits(bool lockstep) {
    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) == 0) {
        limit.rlim_cur = limit.rlim_max;
        ::setrlimit(RLIMIT_NOFILE, &limit);
    }
    if (!lockstep) {
        rlimit const unlimited{RLIM_INFINITY, RLIM_INFINITY};
        ::setrlimit(RLIMIT_MEMLOCK, &unlimited); // only root may
    }
}

} // namespace

Supervisor::Supervisor(RunPlan const& plan, int channel, std::map<std::string, UniqueFd> const& listen_fds)
    : plan_{plan}, channel_{channel}, news_{channel}, listen_fds_{listen_fds} {
    for (PlannedProcess const& process : plan.processes) {
        watched_.emplace_back().plan = process;
    }
    if (plan.board_places > 0) {
        board_ = bus::Board::create(plan.board_places);
    }
}

int Supervisor::run() {
    if (plan_.namespaces) {
        if (auto ok = network_.build(plan_); !ok) {
            return news_.over(ok.error());
        }
        tell_networks();
    }
    if (auto ok = start_all(); !ok) {
        end_all();
        return news_.over(ok.error());
    }
    while (!over()) {
        step();
    }
    end_all();
    return news_.over(failure_);
}

void Supervisor::tell_networks() {
    for (WatchedProcess& w : watched_) {
        std::string text;
        for (std::string const& host : w.plan.networks) {
            text += fmt::format("{}{}=/proc/1/fd/{}", text.empty() ? "" : " ", host, network_.host(host));
        }
        if (!text.empty()) {
            w.plan.environment["GRIDSPACE_NETWORKS"] = text;
        }
    }
}

Result<void> Supervisor::start(WatchedProcess& w) {
    SpawnOptions options;
    options.netns = plan_.namespaces ? network_.host(w.plan.host) : -1;
    if (auto const it = listen_fds_.find(w.plan.name); it != listen_fds_.end()) {
        options.listen_fd = it->second.get();
    }
    if (!board_) {
        return std::unexpected{board_.error()};
    }
    options.board_fd = w.plan.is_member || w.plan.is_simulator ? board_->get() : -1;
    if (auto ok = w.start(options); !ok) {
        return ok;
    }
    news_.tell(nlohmann::ordered_json{{"kind", "started"}, {"process", w.plan.name}, {"incarnation", w.incarnation}});
    return {};
}

Result<void> Supervisor::start_all() {
    std::vector<WatchedProcess*> others;
    for (WatchedProcess& w : watched_) {
        if (w.is_external()) {
            continue;
        }
        if (w.plan.ready_says.empty()) {
            others.push_back(&w);
        } else if (auto ok = start(w); !ok) {
            return ok;
        }
    }
    for (WatchedProcess const& w : watched_) {
        if (!failure_) {
            wait_until_ready(w);
        }
    }
    return start_gradually(std::move(others));
}

Result<void> Supervisor::start_gradually(std::vector<WatchedProcess*> processes) {
    if (processes.size() > GradualStart::kAtOnce) { // those for whom most look have to be there
        std::ranges::stable_sort(processes, std::greater{}, [](auto const* w) { return w->plan.acquaintances; });
    }
    GradualStart gradual;
    auto const has_room = [&] {
        std::size_t looking = 0, matched = 0;
        for (WatchedProcess const* const w : processes) {
            matched += w->matched ? 1 : 0;
            looking += w->running && w->plan.has_status && !w->matched ? 1 : 0;
        }
        return gradual.has_room(looking, matched);
    };
    for (WatchedProcess* const w : processes) {
        while (!failure_ && !has_room()) {
            step();
        }
        if (failure_) {
            break;
        }
        if (auto ok = start(*w); !ok) {
            return ok;
        }
    }
    return {};
}

void Supervisor::wait_until_ready(WatchedProcess const& w) {
    if (w.plan.ready_says.empty()) {
        return;
    }
    OutputWatch output{w.plan.log_file, w.plan.ready_says};
    WaitedTime waited;
    while (!failure_ && w.running && !output.found()) {
        step();
        if (waited.look().count() > w.plan.ready_within_s) {
            fail_with(
                {ExitCode::stall,
                 fmt::format("process '{}' has not said '{}' within {} s of its start", w.plan.name, w.plan.ready_says,
                             shortest(w.plan.ready_within_s)),
                 fmt::format("its output is in {}; `ready: {{within_s: ...}}` allows more", w.plan.log_file.string())});
        }
    }
    if (!failure_ && !output.found()) {
        fail_with({ExitCode::child_died, fmt::format("process '{}' ended before it was ready", w.plan.name),
                   fmt::format("its output is in {}", w.plan.log_file.string())});
    }
}

bool Supervisor::over() {
    if (failure_) {
        return true;
    }
    auto const now = Clock::now();
    auto const patience = end_patience();
    if (suspect_ && !simulator_done_ && patience && now > suspect_->first + *patience) {
        fail_with(suspicion());
        return true;
    }
    if (!simulator_done_) {
        watch_simulator(now);
        return failure_.has_value();
    }
    auto const is_awaited = [](WatchedProcess const& w) { return w.running && !w.plan.is_observer && !w.paused; };
    bool const members_done = std::none_of(watched_.begin(), watched_.end(), is_awaited);
    if (!members_done && patience && now > *simulator_done_ + *patience) {
        for (WatchedProcess const& w : watched_) {
            if (is_awaited(w)) {
                fail_with({ExitCode::stall,
                           fmt::format("process '{}' did not end within {} s of the last tick", w.plan.name,
                                       shortest(patience->count())),
                           "see its log"});
            }
        }
    }
    return members_done || failure_.has_value();
}

std::optional<std::chrono::duration<double>> Supervisor::end_patience() const {
    if (plan_.member_timeout_s <= 0) {
        return std::nullopt;
    }
    return std::chrono::duration<double>{std::max(10.0, 2 * plan_.member_timeout_s)};
}

std::vector<WatchedProcess>::iterator Supervisor::simulator() {
    return std::find_if(watched_.begin(), watched_.end(), [](WatchedProcess const& w) { return w.plan.is_simulator; });
}

void Supervisor::watch_simulator(Clock::time_point now) {
    auto const sim = simulator();
    if (sim == watched_.end() || !sim->running || plan_.member_timeout_s <= 0) {
        return;
    }
    if (auto stall = standstill_.look(sim->plan.name, sim->child.pid, plan_.member_timeout_s, now)) {
        fail_with(std::move(*stall));
    }
}

void Supervisor::bring_back_monitor() {
    auto const now = Clock::now();
    for (WatchedProcess& w : watched_) {
        if (!w.comes_back || now < *w.comes_back || failure_ || simulator_done_) {
            continue;
        }
        w.comes_back.reset();
        w.next_incarnation();
        if (!start(w)) {
            w.comes_back = now + kPauseOfMonitor;
            continue;
        }
        news_.tell(
            nlohmann::ordered_json{{"kind", "returned"}, {"process", w.plan.name}, {"incarnation", w.incarnation}});
    }
}

void Supervisor::step() {
    bring_back_monitor();
    std::vector<pollfd> fds{{channel_, static_cast<short>(news_.waits() ? POLLIN | POLLOUT : POLLIN), 0}};
    std::vector<WatchedProcess*> owners{nullptr};
    for (WatchedProcess& w : watched_) {
        if (w.running) {
            fds.push_back({w.child.pidfd, POLLIN, 0});
            owners.push_back(&w);
        }
        if (w.child.status_fd >= 0) {
            fds.push_back({w.child.status_fd, POLLIN, 0});
            owners.push_back(&w);
        }
    }
    if (::poll(fds.data(), fds.size(), 200) <= 0) {
        return;
    }
    // What a process said comes before its end.
    for (std::size_t i = 1; i < fds.size(); ++i) {
        if (fds[i].revents != 0 && fds[i].fd == owners[i]->child.status_fd) {
            read_status(*owners[i]);
        }
    }
    for (std::size_t i = 1; i < fds.size(); ++i) {
        if (fds[i].revents != 0 && owners[i]->running && fds[i].fd == owners[i]->child.pidfd) {
            reap(*owners[i]);
        }
    }
    news_.flush();
    if ((fds[0].revents & ~POLLOUT) != 0) {
        read_channel();
    }
    if (plan_.namespaces) { // as process 1
        reap_strays(watched_);
    }
}

void Supervisor::end_all() {
    for (WatchedProcess& w : watched_) {
        if (w.running) {
            w.expected_to_die = w.asked_to_end = true;
            ::kill(-w.child.pid, SIGCONT);
            ::kill(-w.child.pid, SIGTERM);
        }
    }
    auto const end_those = [&](auto deadline, auto const& concerns) {
        auto const is_awaited = [&](WatchedProcess const& w) { return w.running && concerns(w); };
        while (std::any_of(watched_.begin(), watched_.end(), is_awaited) && Clock::now() < deadline) {
            step();
        }
        for (WatchedProcess& w : watched_) {
            if (concerns(w)) {
                kill_and_reap(w);
            }
        }
    };
    auto const asked = Clock::now();
    end_those(asked + seconds{2}, [](WatchedProcess const& w) { return w.plan.program != "gridspace-recorder"; });
    end_those(asked + seconds{10}, [](WatchedProcess const&) { return true; });
}

int supervise(RunPlan const& plan, int channel, std::map<std::string, UniqueFd> const& listen_fds) {
    std::signal(SIGPIPE, SIG_IGN);
    raise_limits(plan.lockstep);
    return Supervisor{plan, channel, listen_fds}.run();
}

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/supervisor.hpp"

#include "bus/board/board.hpp"
#include "common/text.hpp"
#include "common/waited_time.hpp"
#include "launcher/run/output_watch.hpp"
#include "launcher/run/run_news.hpp"
#include "launcher/run/simulator_standstill.hpp"
#include "launcher/run/virtual_network.hpp"
#include "launcher/run/watched_process.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;
using std::chrono::seconds;

class Supervisor {
  public:
    Supervisor(RunPlan const& plan, int channel, std::map<std::string, UniqueFd> const& listen_fds)
        : plan_{plan}, channel_{channel}, news_{channel}, listen_fds_{listen_fds} {
        for (PlannedProcess const& process : plan.processes) {
            watched_.emplace_back().plan = process;
        }
        if (plan.board_places > 0) {
            board_ = bus::Board::create(plan.board_places);
        }
    }

    int run() {
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

  private:
    static constexpr seconds kPauseOfMonitor{1}; ///< before it is started again; one that fails at once is no load
    /// Who looks into the networks of other hosts finds them by descriptors of this process, which is process 1.
    void tell_networks() {
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

    Result<void> start(WatchedProcess& w) {
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
        news_.tell(Json{{"kind", "started"}, {"process", w.plan.name}, {"incarnation", w.incarnation}});
        return {};
    }

    /// First those whose readiness is waited for: the others wait for each other, with a deadline.
    Result<void> start_all() {
        for (bool const first : {true, false}) {
            for (WatchedProcess& w : watched_) {
                if (w.is_external() || w.plan.ready_says.empty() == first) {
                    continue;
                }
                if (auto ok = start(w); !ok) {
                    return ok;
                }
            }
            for (WatchedProcess const& w : watched_) {
                if (first && !failure_) {
                    wait_until_ready(w);
                }
            }
            if (failure_) {
                break;
            }
        }
        return {};
    }

    /// Of somebody's own program that says so in its output.
    void wait_until_ready(WatchedProcess const& w) {
        if (w.plan.ready_says.empty()) {
            return;
        }
        OutputWatch output{w.plan.log_file, w.plan.ready_says};
        WaitedTime waited;
        while (!failure_ && w.running && !output.found()) {
            step();
            if (waited.look().count() > w.plan.ready_within_s) {
                fail_with({ExitCode::stall,
                           fmt::format("process '{}' has not said '{}' within {} s of its start", w.plan.name,
                                       w.plan.ready_says, shortest(w.plan.ready_within_s)),
                           fmt::format("its output is in {}; `ready: {{within_s: ...}}` allows more",
                                       w.plan.log_file.string())});
            }
        }
        if (!failure_ && !output.found()) {
            fail_with({ExitCode::child_died, fmt::format("process '{}' ended before it was ready", w.plan.name),
                       fmt::format("its output is in {}", w.plan.log_file.string())});
        }
    }

    /// The run is over: it failed, was stopped, or the simulator has finished and everybody who follows it has too.
    bool over() {
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

    /// How long the members may take to end after the simulator, or the simulator after the first of them. None without
    /// deadlines.
    [[nodiscard]] std::optional<std::chrono::duration<double>> end_patience() const {
        if (plan_.member_timeout_s <= 0) {
            return std::nullopt;
        }
        return std::chrono::duration<double>{std::max(10.0, 2 * plan_.member_timeout_s)};
    }

    std::vector<WatchedProcess>::iterator simulator() {
        return std::find_if(watched_.begin(), watched_.end(),
                            [](WatchedProcess const& w) { return w.plan.is_simulator; });
    }

    void watch_simulator(Clock::time_point now) {
        auto const sim = simulator();
        if (sim == watched_.end() || !sim->running || plan_.member_timeout_s <= 0) {
            return;
        }
        if (auto stall = standstill_.look(sim->plan.name, sim->child.pid, plan_.member_timeout_s, now)) {
            fail_with(std::move(*stall));
        }
    }

    void bring_back_monitor() {
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
            news_.tell(Json{{"kind", "returned"}, {"process", w.plan.name}, {"incarnation", w.incarnation}});
        }
    }

    void step() {
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

    void read_channel() {
        char buffer[256];
        ssize_t const size = ::read(channel_, buffer, sizeof buffer);
        if (size <= 0 ||
            std::string_view{buffer, static_cast<std::size_t>(size)}.find("stop") != std::string_view::npos) {
            fail_with({ExitCode::interrupted, "stopped", ""});
        }
    }

    void read_status(WatchedProcess& w) {
        for (std::string const& line : w.read_status()) {
            Json status = Json::parse(line, nullptr, false);
            if (status.is_object()) {
                on_status(w, status);
            }
        }
    }

    void on_status(WatchedProcess& w, Json& status) {
        std::string const what = status.value("status", "");
        if (what == "failed") {
            w.reported = Error{static_cast<ExitCode>(status.value("code", 4)), status.value("message", ""),
                               status.value("remedy", "")};
            // The simulator names the culprit of a stall; others notice the consequences.
            if (w.plan.is_simulator && !failure_) {
                fail_with(
                    {w.reported->code, fmt::format("{}: {}", w.plan.name, w.reported->message), w.reported->remedy});
            }
        } else if (what == "hold") {
            strike(w, status.value("index", std::size_t{0}));
        } else if (what == "control") {
            control(w, status.value("action", ""));
        }
        bool const only_the_newest =
            what == "progress" && status.value("time_s", 0.0) < status.value("duration_s", 0.0);
        status["kind"] = "status";
        status["process"] = w.plan.name;
        news_.tell(status, only_the_newest);
    }

    void reap(WatchedProcess& w) {
        auto const end = w.reap();
        if (!end) {
            return;
        }
        read_status(w); // its last words
        // The usual end of a program that somebody else wrote and that runs until it gets SIGTERM.
        bool const did_as_asked = w.asked_to_end && end->signal() == SIGTERM;
        news_.tell(Json{{"kind", "exit"},
                        {"process", w.plan.name},
                        {"how", did_as_asked ? "ended when asked" : end->text()},
                        {"code", did_as_asked ? 0 : end->code()},
                        {"expected", w.expected_to_die},
                        {"cpu_s", end->cpu_s}});
        if (!w.expected_to_die && !failure_) {
            judge_end(w, *end);
        }
    }

    /// Of a process that nobody has asked to end.
    void judge_end(WatchedProcess& w, WatchedProcess::End const& end) {
        // A board turns itself off in any case: what its program said counts.
        bool const clean = end.code() == 0 && !(w.plan.run_on.kind == RunOn::Kind::qemu_system && w.reported);
        if (w.plan.is_simulator) {
            if (clean) {
                simulator_done_ = Clock::now();
            } else {
                fail_with({w.reported ? w.reported->code : ExitCode::child_died,
                           fmt::format("the simulator '{}' ended: {}", w.plan.name, end.text()), "see its log"});
            }
            return;
        }
        if (w.only_looks()) { // it decides nothing: the run goes on without it, and later with it
            w.comes_back = Clock::now() + kPauseOfMonitor;
            return;
        }
        if (clean && !simulator_done_) {
            if (w.plan.is_member &&
                !suspect_) { // it may just be quicker with the last tick than the simulator, who waits for the recorder
                suspect_ = {Clock::now(), w.plan.name};
            }
            if (w.plan.is_guest) { // a host is there until the end, and an emulator does not tell a panic from shutdown
                fail_with(
                    {ExitCode::child_died,
                     fmt::format("process '{}', a guest, ended before the run did, with exit code 0", w.plan.name),
                     "see its log: has the machine turned itself off, or has its kernel panicked?"});
            }
            return;
        }
        if (!clean && (!w.plan.is_observer || !simulator_done_)) {
            Error error{ExitCode::child_died, fmt::format("process '{}' died: {}", w.plan.name, end.text()),
                        "see its log"};
            if (w.reported) {
                error = {w.reported->code == ExitCode::interrupted ? ExitCode::child_died : w.reported->code,
                         fmt::format("{}: {}", w.plan.name, w.reported->message), w.reported->remedy};
            }
            fail_with(std::move(error));
        }
    }

    /// What a user asks for in the dashboard. Only the monitor may, and only when the run was started so.
    void control(WatchedProcess const& from, std::string const& action) {
        if (!plan_.allow_control || !from.plan.is_observer) {
            return;
        }
        if (action == "stop") {
            fail_with({ExitCode::interrupted, fmt::format("stopped through {}", from.plan.name), ""});
            return;
        }
        auto const sim = simulator();
        if (plan_.lockstep && sim != watched_.end() && sim->running) {
            std::string const line = action + "\n";
            [[maybe_unused]] auto const written = ::write(sim->child.control_fd, line.data(), line.size());
        }
    }

    /// Carries out what the timeline does to processes at a held tick, then lets the simulator go on.
    void strike(WatchedProcess& simulator, std::size_t index) {
        std::string answer;
        using Kind = ProcessAction::Kind;
        if (index < plan_.holds.size()) {
            for (ProcessAction const& action : plan_.holds[index]) {
                auto const w = std::find_if(watched_.begin(), watched_.end(),
                                            [&](WatchedProcess const& x) { return x.plan.name == action.process; });
                char const* text = "killed";
                switch (action.kind) {
                case Kind::kill:
                    w->expected_to_die = true;
                    kill_and_reap(*w);
                    answer += "drop " + action.process + "\n";
                    break;
                case Kind::pause:
                    // In lockstep it gets no ticks. A stopped process would lose samples, depending on the machine.
                    if (!plan_.lockstep) {
                        ::kill(-w->child.pid, SIGSTOP);
                    }
                    w->paused = true;
                    answer += "drop " + action.process + "\n";
                    text = "paused";
                    break;
                case Kind::resume:
                    ::kill(-w->child.pid, SIGCONT);
                    w->paused = false;
                    answer += "rejoin " + action.process + "\n";
                    text = "resumed";
                    break;
                case Kind::restart:
                    w->expected_to_die = true;
                    w->paused = false;
                    kill_and_reap(*w);
                    if (!restart(*w, action.at_s)) {
                        return;
                    }
                    answer += fmt::format("restarted {} {}\n", action.process, w->incarnation);
                    text = "restarted";
                    break;
                }
                news_.tell(Json{{"kind", "process_action"},
                                {"event", action.event},
                                {"process", action.process},
                                {"what", text},
                                {"time_s", action.at_s}});
            }
        }
        answer += "go\n";
        [[maybe_unused]] auto const written = ::write(simulator.child.control_fd, answer.data(), answer.size());
    }

    void kill_and_reap(WatchedProcess& w) {
        if (w.running) {
            ::kill(-w.child.pid, SIGKILL);
            reap(w);
        }
    }

    bool restart(WatchedProcess& w, double at_s) {
        std::vector<std::string> absent;
        for (WatchedProcess const& other : watched_) {
            if (!other.running && &other != &w && !other.is_external()) {
                absent.push_back(other.plan.name);
            }
        }
        w.next_incarnation(at_s, absent);
        if (auto ok = start(w); !ok) {
            fail_with(ok.error());
            return false;
        }
        w.expected_to_die = false;
        return true;
    }

    /// Ends what still runs: a request, two seconds (ten for who has to finish a recording on a slow disk), then force.
    void end_all() {
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

    [[nodiscard]] Error suspicion() const {
        return {ExitCode::child_died,
                fmt::format("process '{}' ended before the run did, with exit code 0", suspect_->second),
                "see its log; a member stays until the last tick"};
    }

    void fail_with(Error error) {
        if (!failure_) {
            if (error.code == ExitCode::stall && suspect_ && !simulator_done_) { // who has gone does not answer
                error = suspicion();
            } else if (error.code == ExitCode::stall) {
                error = stopped_ones(watched_).value_or(std::move(error));
            }
            news_.tell(Json{{"kind", "failed"},
                            {"code", static_cast<int>(error.code)},
                            {"cause", error.message}}); // before the others end of it
            failure_ = std::move(error);
        }
    }

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

int supervise(RunPlan const& plan, int channel, std::map<std::string, UniqueFd> const& listen_fds) {
    std::signal(SIGPIPE, SIG_IGN);
    raise_limits(plan.lockstep);
    return Supervisor{plan, channel, listen_fds}.run();
}

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/follower.hpp"

#include "common/json_value.hpp"
#include "common/lateness_json.hpp"
#include "common/text.hpp"
#include "common/unique_fd.hpp"

#include <chrono>
#include <csignal>
#include <cstdint>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <string>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace gridspace::launcher {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

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
        std::string const kind = text_of(line, "kind"), process = text_of(line, "process");
        if (kind == "status") {
            on_status(process, line);
        } else if (kind == "exit") {
            std::erase_if(outcome_.ends, [&](auto const& e) { return e.process == process; });
            outcome_.ends.push_back(
                {process, text_of(line, "how"), value_of(line, "code", 0), value_of(line, "cpu_s", 0.0)});
            if (value_of(line, "code", 0) != 0 &&
                !value_of(line, "expected", false)) { // a planned kill is an event already
                events_.write(time_s_, process, "exit", text_of(line, "how"));
            }
        } else if (kind == "returned") {
            events_.write(time_s_, process, "started_again",
                          fmt::format("incarnation {}; the run went on without it", value_of(line, "incarnation", 0)));
        } else if (kind == "process_action") {
            std::string const text = fmt::format("{} {}", text_of(line, "process"), text_of(line, "what"));
            events_.write(value_of(line, "time_s", 0.0), "launcher", text_of(line, "event"), text);
            progress_.event(value_of(line, "time_s", 0.0), "launcher", text_of(line, "event"), text);
        } else if (kind == "failed") {
            bool const stopped = value_of(line, "code", 0) == static_cast<int>(ExitCode::interrupted);
            events_.write(time_s_, "launcher", stopped ? "run_stopped" : "run_failed", text_of(line, "cause"));
        } else if (kind == "over") {
            over_ = true;
            outcome_.exit_code = value_of(line, "code", 0);
            outcome_.cause = text_of(line, "cause");
            outcome_.remedy = text_of(line, "remedy");
            if (auto const left_out = value_of(line, "left_out", std::uint64_t{0}); left_out > 0) {
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
        auto const at_ns = value_of(line, "at_ns", std::int64_t{0});
        return at_ns == 0 ? Clock::now() : Clock::time_point{std::chrono::nanoseconds{at_ns}};
    }

    void on_status(std::string const& process, Json const& line) {
        std::string const status = text_of(line, "status");
        if (status == "ready") {
            progress_.note(ready_text());
            clock_started_ = last_progress_ = instant_of(line);
            started_ = true;
        } else if (status == "progress") {
            time_s_ = value_of(line, "time_s", 0.0);
            last_progress_ = instant_of(line);
            outcome_.overruns = value_of(line, "overruns", std::uint64_t{0});
            progress_.update(time_s_, outcome_.overruns);
        } else if (status == "lateness") {
            outcome_.ticks = lateness_of(line);
        } else if (status == "event") {
            events_.write(value_of(line, "time_s", 0.0), value_of(line, "source", process), text_of(line, "event"),
                          text_of(line, "text"));
            progress_.event(value_of(line, "time_s", 0.0), value_of(line, "source", process), text_of(line, "event"),
                            text_of(line, "text"));
        } else if (status == "paused" || status == "resumed") {
            time_s_ = value_of(line, "time_s", 0.0);
            events_.write(time_s_, "launcher", status, fmt::format("the run is {}", status));
            progress_.note(fmt::format("the run is {} at {} s", status, time_s_));
        } else if (status == "serving") {
            progress_.note(fmt::format("{}: {}", process, text_of(line, "url")));
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

} // namespace

RunOutcome follow(RunPlan const& plan, pid_t supervisor, int channel, Progress& progress, EventLog& events,
                  InterruptWatch& interrupts) {
    return Follower{plan, progress, events}.follow(supervisor, channel, interrupts);
}

} // namespace gridspace::launcher

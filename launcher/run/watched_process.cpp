// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/watched_process.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <sys/resource.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace gridspace::launcher {
namespace {

double seconds_of(timeval t) {
    return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) / 1e6;
}

std::filesystem::path pid_file(PlannedProcess const& plan) {
    return plan.config_file.parent_path() / (plan.name + ".pid");
}

} // namespace

int WatchedProcess::End::code() const {
    return WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : 128 + WTERMSIG(wait_status);
}

int WatchedProcess::End::signal() const {
    return WIFSIGNALED(wait_status) ? WTERMSIG(wait_status) : 0;
}

std::string WatchedProcess::End::text() const {
    return describe_end(wait_status);
}

Result<void> WatchedProcess::start(SpawnOptions const& options) {
    auto started = spawn(plan, options);
    if (!started) {
        return std::unexpected{started.error()};
    }
    child = *started;
    running = true;
    matched = false;
    pending.clear();
    std::ofstream{pid_file(plan)} << child.pid << '\n'; // without it the monitor says nothing of the process
    return {};
}

std::vector<std::string> WatchedProcess::read_status() {
    char buffer[4096];
    ssize_t size = 0;
    while ((size = ::read(child.status_fd, buffer, sizeof buffer)) > 0) {
        pending.append(buffer, static_cast<std::size_t>(size));
    }
    if (size == 0) {
        ::close(std::exchange(child.status_fd, -1));
    }
    std::vector<std::string> lines;
    constexpr std::size_t kLongestLine = 64U * 1024U;
    if (pending.size() > kLongestLine && pending.find('\n') == std::string::npos) {
        pending.clear(); // no line of ours is that long, and one without an end would grow for ever
    }
    for (std::size_t end = 0; (end = pending.find('\n')) != std::string::npos; pending.erase(0, end + 1)) {
        lines.push_back(pending.substr(0, end));
    }
    return lines;
}

std::optional<WatchedProcess::End> WatchedProcess::reap() {
    End end;
    rusage used{};
    if (::wait4(child.pid, &end.wait_status, 0, &used) != child.pid) {
        return std::nullopt;
    }
    end.cpu_s = seconds_of(used.ru_utime) + seconds_of(used.ru_stime);
    running = false;
    ::close(std::exchange(child.pidfd, -1));
    ::close(std::exchange(child.control_fd, -1));
    std::error_code ignored;
    std::filesystem::remove(pid_file(plan), ignored);
    return end;
}

void WatchedProcess::next_incarnation() {
    ++incarnation;
    plan.config.find("bus")->set("incarnation", config::Node::scalar(std::to_string(incarnation)));
    reported.reset();
    write_config();
}

void WatchedProcess::next_incarnation(double at_s, std::vector<std::string> const& absent) {
    config::Node& bus = *plan.config.find("bus");
    bus.set("joins_at_s", config::Node::scalar(shortest(at_s)));
    config::Node names = config::Node::sequence();
    for (std::string const& name : absent) {
        names.items.push_back(config::Node::scalar(name));
    }
    bus.set("absent", std::move(names));
    next_incarnation();
    plan.environment["GRIDSPACE_INCARNATION"] = std::to_string(incarnation);
    plan.environment["GRIDSPACE_JOINS_AT_S"] = shortest(at_s);
    plan.environment["GRIDSPACE_ABSENT"] = join(absent, " ");
}

void WatchedProcess::write_config() const {
    std::ofstream{plan.config_file} << to_yaml(plan.config);
}

void reap_strays(std::vector<WatchedProcess> const& watched) {
    siginfo_t info{};
    while (::waitid(P_ALL, 0, &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid != 0 &&
           std::none_of(watched.begin(), watched.end(),
                        [&](WatchedProcess const& w) { return w.running && w.child.pid == info.si_pid; })) {
        ::waitpid(info.si_pid, nullptr, 0);
        info = {};
    }
}

std::optional<Error> stopped_ones(std::vector<WatchedProcess> const& watched) {
    std::vector<std::string> names;
    for (WatchedProcess const& w : watched) {
        if (w.running && !w.paused && !w.plan.is_observer && is_stopped(w.child.pid)) {
            names.push_back("'" + w.plan.name + "'");
        }
    }
    if (names.empty()) {
        return std::nullopt;
    }
    return Error{ExitCode::stall,
                 fmt::format("{} {} stopped, by a signal (SIGSTOP, SIGTSTP) or a debugger",
                             names.size() == 1 ? "process" : "processes",
                             join(names, ", ") + (names.size() == 1 ? " is" : " are")),
                 "`clock: {member_timeout_s: 0}` lets a run wait for a process in a debugger"};
}

} // namespace gridspace::launcher

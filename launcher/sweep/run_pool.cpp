// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/run_pool.hpp"

#include "common/child_process.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sched.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

/// In the child: only what is safe after fork.
[[noreturn]] void become(std::vector<char*> const& arguments, cpu_set_t const& processors, pid_t parent, int output) {
    begin_child(parent); // a Ctrl-C is for the sweep, which then ends its runs
    if (CPU_COUNT(&processors) > 0) {
        ::sched_setaffinity(0, sizeof processors, &processors);
    }
    int const nothing = ::open("/dev/null", O_RDONLY);
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(output, STDOUT_FILENO);
    ::dup2(output, STDERR_FILENO);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
}

} // namespace

std::vector<int> usable_processors() {
    cpu_set_t set;
    CPU_ZERO(&set);
    ::sched_getaffinity(0, sizeof set, &set);
    std::vector<int> out;
    for (std::size_t cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
        if (CPU_ISSET(cpu, &set)) {
            out.push_back(static_cast<int>(cpu));
        }
    }
    return out;
}

RunPool::RunPool(std::size_t jobs) : slots_(jobs) {
    std::vector<int> const all = usable_processors();
    for (std::size_t i = 0; jobs > 1 && jobs <= all.size() && i < all.size(); ++i) {
        slots_[i * jobs / all.size()].processors.push_back(all[i]);
    }
}

RunPool::~RunPool() {
    for (Slot const& slot : slots_) {
        if (slot.pid > 0) {
            ::kill(slot.pid, SIGKILL);
            ::waitpid(slot.pid, nullptr, 0);
        }
    }
}

bool RunPool::has_room() const {
    return running() < slots_.size();
}

std::size_t RunPool::running() const {
    return static_cast<std::size_t>(
        std::count_if(slots_.begin(), slots_.end(), [](Slot const& slot) { return slot.pid > 0; }));
}

Result<void> RunPool::start(std::size_t task, std::vector<std::string> const& command,
                            std::filesystem::path const& output) {
    UniqueFd const log{::open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)};
    if (!log) {
        return fail(ExitCode::environment, fmt::format("cannot write '{}': {}", output.string(), std::strerror(errno)));
    }
    Slot& slot = *std::find_if(slots_.begin(), slots_.end(), [](Slot const& s) { return s.pid <= 0; });
    std::vector<std::string> words = command;
    std::vector<char*> arguments;
    for (std::string& word : words) {
        arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    cpu_set_t processors;
    CPU_ZERO(&processors);
    for (int const cpu : slot.processors) {
        CPU_SET(static_cast<std::size_t>(cpu), &processors);
    }
    pid_t const parent = ::getpid();
    pid_t const pid = ::fork();
    if (pid == 0) {
        become(arguments, processors, parent, log.get());
    }
    if (pid < 0) {
        return fail(ExitCode::environment, fmt::format("cannot start '{}': {}", command.front(), std::strerror(errno)));
    }
    slot.pid = pid;
    slot.pidfd.reset(static_cast<int>(::syscall(SYS_pidfd_open, pid, 0)));
    slot.task = task;
    slot.begin = std::chrono::steady_clock::now();
    return {};
}

std::optional<RunPool::Ended> RunPool::wait(std::chrono::milliseconds timeout, int wake) {
    std::vector<pollfd> fds{{wake, POLLIN, 0}};
    for (Slot const& slot : slots_) {
        fds.push_back({slot.pid > 0 ? slot.pidfd.get() : -1, POLLIN, 0});
    }
    ::poll(fds.data(), fds.size(), static_cast<int>(timeout.count()));
    for (std::size_t i = 0; i < slots_.size(); ++i) {
        Slot& slot = slots_[i];
        int status = 0;
        if (slot.pid <= 0 || ::waitpid(slot.pid, &status, WNOHANG) != slot.pid) {
            continue;
        }
        slot.pid = -1;
        slot.pidfd.reset();
        double const wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - slot.begin).count();
        return Ended{slot.task, WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status), wall_s};
    }
    return std::nullopt;
}

void RunPool::interrupt() const {
    for (Slot const& slot : slots_) {
        if (slot.pid > 0) {
            ::kill(slot.pid, SIGINT);
        }
    }
}

} // namespace gridspace::launcher

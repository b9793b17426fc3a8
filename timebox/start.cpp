// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/start.hpp"

#include "common/privileges/capabilities.hpp"
#include "common/unique_fd.hpp"
#include "timebox/door_channel.hpp"
#include "timebox/held_calls.hpp"
#include "timebox/stops.hpp"
#include "timebox/tracee.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/close_range.h>
#include <sys/personality.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>

namespace gridspace::timebox {
namespace {

enum class Step : int { trace = 1, filter, exec };

/// For exec: pointers to texts, and behind them nothing.
std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> out;
    out.reserve(texts.size() + 1);
    for (std::string& text : texts) {
        out.push_back(text.data());
    }
    out.push_back(nullptr);
    return out;
}

std::vector<std::string> environment_with(std::vector<std::pair<std::string, std::string>> const& more) {
    std::vector<std::string> out;
    for (char** entry = environ; *entry != nullptr; ++entry) {
        out.emplace_back(*entry);
    }
    for (auto const& [name, value] : more) {
        if (::getenv(name.c_str()) == nullptr) {
            out.push_back(name + "=" + value);
        }
    }
    return out;
}

/// In the child: nothing but calls of the kernel. `door_fd`: becomes kDoorFd; -1: none.
[[noreturn]] void become(char* const* arguments, char* const* environment, int report, bool detached, int door_fd) {
    auto const give_up = [&](Step step, int error) {
        std::array<int, 2> const said{static_cast<int>(step), error};
        (void)!::write(report, said.data(), sizeof said);
        ::_exit(127);
    };
    if (detached) {
        ::setpgid(0, 0); // not a session: the scheduler would take it for somebody else's work
        int const nothing = ::open("/dev/null", O_RDONLY);
        ::dup2(nothing, STDIN_FILENO);
        ::syscall(SYS_close_range, STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
        keep_only_capabilities(kMayOpenRawSockets); // what it needed to get here is not for the program
    }
    if (door_fd >= 0) {
        report = ::fcntl(report, F_DUPFD_CLOEXEC, kDoorFd + 1);
        ::dup2(door_fd, kDoorFd);
        ::fcntl(kDoorFd, F_SETFD, 0);
    }
    sigset_t none;
    sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    ::signal(SIGPIPE, SIG_DFL);
    ::personality(ADDR_NO_RANDOMIZE); // where it is forbidden, addresses differ from run to run and nothing else
    ::prctl(PR_SET_TSC, PR_TSC_SIGSEGV);
    if (::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) {
        give_up(Step::trace, errno);
    }
    ::raise(SIGSTOP); // until the options are set: without them the filter would refuse
    if (int const error = install_filter(); error != 0) {
        give_up(Step::filter, error);
    }
    ::raise(SIGSTOP); // until its listener has been taken
    ::execvpe(arguments[0], arguments, environment);
    give_up(Step::exec, errno);
    ::_exit(127);
}

/// From its first stop to the first instruction of its program. False: it has ended.
bool bring_to_program(pid_t pid, std::vector<UniqueFd>& listeners) {
    int status = 0;
    if (::waitpid(pid, &status, __WALL) != pid || !WIFSTOPPED(status)) {
        return false;
    }
    constexpr unsigned long kOptions = PTRACE_O_EXITKILL | PTRACE_O_TRACESECCOMP | PTRACE_O_TRACEEXEC |
                                       PTRACE_O_TRACECLONE | PTRACE_O_TRACEFORK | PTRACE_O_TRACEVFORK |
                                       PTRACE_O_TRACEVFORKDONE | PTRACE_O_TRACESYSGOOD;
    ::ptrace(PTRACE_SETOPTIONS, pid, nullptr, kOptions);
    Stops stops;
    let_run(pid, GoOn::run, 0);
    while (true) { // calls of the child before its exec are none of the program's
        Stop told;
        Stops::Why const why = stops.wait(told, pid);
        if (why == Stops::Why::interrupted) {
            continue;
        }
        if (why == Stops::Why::nobody_is_left || (!told.call && !WIFSTOPPED(told.status))) {
            return false;
        }
        if (!told.call && told.status >> 8 == (SIGTRAP | PTRACE_EVENT_EXEC << 8)) {
            return true;
        }
        if (!told.call && told.status >> 8 == SIGSTOP) {
            if (UniqueFd listener = listener_of(pid)) {
                stops.listen(UniqueFd{::fcntl(listener.get(), F_DUPFD_CLOEXEC, 0)});
                listeners.push_back(std::move(listener));
            }
        }
        let_run(pid, GoOn::run, 0);
    }
}

Error why(std::array<int, 2> const& said, std::string const& program) {
    switch (static_cast<Step>(said[0])) {
    case Step::exec:
        return {ExitCode::environment, fmt::format("cannot start '{}': {}", program, std::strerror(said[1])), ""};
    case Step::filter:
        return {ExitCode::environment, fmt::format("no filter of system calls: {}", std::strerror(said[1])),
                "simulated time needs seccomp; `gridspace doctor` shows what is missing"};
    case Step::trace:
        break;
    }
    return {
        ExitCode::environment, fmt::format("programs cannot be traced: {}", std::strerror(said[1])),
        "simulated time needs ptrace: in a container --cap-add SYS_PTRACE, or its default seccomp profile of today"};
}

} // namespace

Result<Started> start_traced(StartOptions const& options) {
    std::vector<std::vector<std::string>> commands{options.command};
    if (!options.door.empty()) {
        commands.push_back(options.door);
    }
    std::vector<std::vector<char*>> arguments;
    for (auto& command : commands) {
        arguments.push_back(pointers(command));
    }
    std::vector<std::string> environment = environment_with(options.environment);
    std::vector<char*> const variables = pointers(environment);
    std::array<int, 2> ends{-1, -1};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
        return fail(ExitCode::environment, fmt::format("no pipe: {}", std::strerror(errno)));
    }
    UniqueFd const from{ends[0]};
    UniqueFd to{ends[1]};
    Started out;
    std::array<pid_t, 2> children{};
    std::span<pid_t> const made = std::span{children}.first(commands.size());
    if (int const which = fork_numbered(out.numbers, made); which >= 0) {
        auto const at = static_cast<std::size_t>(which);
        become(arguments[at].data(), variables.data(), to.get(), options.detached, at == 1 ? options.door_fd : -1);
    }
    to.reset();
    for (std::size_t i = 0; i < made.size(); ++i) {
        if (made[i] > 0 && bring_to_program(made[i], out.listeners)) {
            continue;
        }
        for (pid_t const pid : made) {
            if (pid > 0) {
                ::kill(pid, SIGKILL);
                ::waitpid(pid, nullptr, __WALL);
            }
        }
        pid_t const keeper = out.numbers.keeper;
        out.numbers.end();
        while (keeper > 0 && ::waitpid(keeper, nullptr, __WALL) < 0 && errno == EINTR) {
        }
        std::array<int, 2> said{};
        bool const complete = ::read(from.get(), said.data(), sizeof said) == static_cast<ssize_t>(sizeof said);
        return std::unexpected{
            complete ? why(said, commands[i][0])
                     : Error{ExitCode::environment, fmt::format("'{}' did not start", commands[i][0]), ""}};
    }
    out.program = made[0];
    out.door = made.size() > 1 ? made[1] : 0;
    return out;
}

} // namespace gridspace::timebox

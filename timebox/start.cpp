// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/start.hpp"

#include "common/unique_fd.hpp"
#include "timebox/held_calls.hpp"

#include <array>
#include <cerrno>
#include <csignal>
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

/// In the child: nothing but calls of the kernel.
[[noreturn]] void become(char* const* arguments, int report, bool detached) {
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
    ::execvp(arguments[0], arguments);
    give_up(Step::exec, errno);
    ::_exit(127);
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

Result<pid_t> start_traced(std::vector<std::string> const& command, bool detached) {
    std::vector<char*> arguments;
    arguments.reserve(command.size() + 1);
    for (std::string const& text : command) {
        arguments.push_back(const_cast<char*>(text.c_str())); // exec takes them so, and changes nothing
    }
    arguments.push_back(nullptr);
    std::array<int, 2> ends{-1, -1};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
        return fail(ExitCode::environment, fmt::format("no pipe: {}", std::strerror(errno)));
    }
    UniqueFd const from{ends[0]};
    UniqueFd to{ends[1]};
    pid_t const pid = ::fork();
    if (pid < 0) {
        return fail(ExitCode::environment, fmt::format("no new process: {}", std::strerror(errno)));
    }
    if (pid == 0) {
        become(arguments.data(), to.get(), detached);
    }
    to.reset();
    auto const failed = [&]() -> Result<pid_t> {
        std::array<int, 2> said{};
        bool const complete = ::read(from.get(), said.data(), sizeof said) == static_cast<ssize_t>(sizeof said);
        ::kill(pid, SIGKILL);
        ::waitpid(pid, nullptr, __WALL);
        return std::unexpected{complete
                                   ? why(said, command[0])
                                   : Error{ExitCode::environment, fmt::format("'{}' did not start", command[0]), ""}};
    };
    int status = 0;
    if (::waitpid(pid, &status, __WALL) != pid || !WIFSTOPPED(status)) {
        return failed();
    }
    constexpr unsigned long kOptions = PTRACE_O_EXITKILL | PTRACE_O_TRACESECCOMP | PTRACE_O_TRACEEXEC |
                                       PTRACE_O_TRACECLONE | PTRACE_O_TRACEFORK | PTRACE_O_TRACEVFORK |
                                       PTRACE_O_TRACEVFORKDONE | PTRACE_O_TRACESYSGOOD;
    ::ptrace(PTRACE_SETOPTIONS, pid, nullptr, kOptions);
    while (true) { // calls of the child before its exec are none of the program's
        ::ptrace(PTRACE_CONT, pid, nullptr, nullptr);
        if (::waitpid(pid, &status, __WALL) != pid || !WIFSTOPPED(status)) {
            return failed();
        }
        if (status >> 8 == (SIGTRAP | PTRACE_EVENT_EXEC << 8)) {
            return pid;
        }
    }
}

} // namespace gridspace::timebox

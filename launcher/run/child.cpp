// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/child.hpp"

#include "common/child_process.hpp"
#include "common/privileges/capabilities.hpp"
#include "common/realtime.hpp"
#include "common/text.hpp"
#include "common/unique_fd.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <optional>
#include <sched.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

constexpr int kStatusFd = 3; // in the child
constexpr int kListenFd = 4;
constexpr int kBoardFd = 5;

struct Pipe {
    UniqueFd read, write;
};

std::optional<Pipe> make_pipe() {
    int fds[2];
    return ::pipe2(fds, O_CLOEXEC) == 0 ? std::optional{Pipe{UniqueFd{fds[0]}, UniqueFd{fds[1]}}} : std::nullopt;
}

/// In the child: becomes the program, which is looked for in PATH when its name is no path; returns only when it
/// cannot, with errno. Not execvp: that gives what no processor here can run to the shell, which then reads it as a
/// script.
void execute(std::vector<char*> const& arguments) {
    std::string_view const name{arguments[0]};
    if (name.empty() || name.find('/') != std::string_view::npos) {
        ::execv(arguments[0], arguments.data());
        return;
    }
    char const* const path = ::getenv("PATH");
    int found = ENOENT;
    for (std::string const& folder : split(path == nullptr ? "/usr/bin:/bin" : path, ':')) {
        std::string const file = (folder.empty() ? "." : folder) + "/" + std::string{name};
        ::execv(file.c_str(), arguments.data());
        if (errno == EACCES) {
            found = EACCES; // another folder may have one that can be run
        } else if (errno != ENOENT && errno != ENOTDIR) {
            return;
        }
    }
    errno = found;
}

/// In the child: reports what fails as "step: reason" on `error_fd`, which closes by itself on success.
[[noreturn]] void give_up(int error_fd, char const* step) {
    std::string const text = errno == ENOEXEC ? fmt::format("{}: no program for this machine's processor, and no "
                                                            "script that begins with #!",
                                                            step)
                                              : fmt::format("{}: {}", step, std::strerror(errno));
    [[maybe_unused]] auto const written = ::write(error_fd, text.data(), text.size());
    ::_exit(127);
}

/// Where and when the process is computed.
void take_processor(PlannedProcess const& process) {
    if (process.cpu) {
        cpu_set_t set;
        CPU_ZERO(&set);
        CPU_SET(static_cast<std::size_t>(*process.cpu), &set);
        ::sched_setaffinity(0, sizeof set, &set); // a processor that does not exist is noted by `doctor`
    }
    if (process.fifo_priority > 0) {
        schedule_fifo(process.fifo_priority); // what came of it the process says in its log
    }
}

/// Standard descriptors, then 3 (status, of who takes it), 4 (listening socket) and 5 (board). Returns where `error_fd`
/// is from now on.
int arrange_descriptors(SpawnOptions const& options, int control_read, int status_write, int log_fd, int error_fd) {
    // Sources are moved above 10 first: no overlap.
    int const control = ::fcntl(control_read, F_DUPFD, 10),
              status = status_write < 0 ? -1 : ::fcntl(status_write, F_DUPFD, 10), log = ::fcntl(log_fd, F_DUPFD, 10),
              listening = options.listen_fd < 0 ? -1 : ::fcntl(options.listen_fd, F_DUPFD, 10),
              board = options.board_fd < 0 ? -1 : ::fcntl(options.board_fd, F_DUPFD, 10),
              error = ::fcntl(error_fd, F_DUPFD_CLOEXEC, 10);
    ::dup2(control, STDIN_FILENO);
    ::dup2(log, STDOUT_FILENO);
    ::dup2(log, STDERR_FILENO);
    if (status >= 0) {
        ::dup2(status, kStatusFd);
    }
    if (listening >= 0) {
        ::dup2(listening, kListenFd);
    }
    if (board >= 0) {
        ::dup2(board, kBoardFd);
        ::setenv("GRIDSPACE_BOARD", std::to_string(kBoardFd).c_str(), 1);
    } else {
        ::unsetenv("GRIDSPACE_BOARD");
    }
    for (int const fd : {control, status, log, listening, board}) {
        if (fd >= 0) {
            ::close(fd);
        }
    }
    return error;
}

/// In the child: never returns.
[[noreturn]] void become(PlannedProcess const& process, SpawnOptions const& options, pid_t parent, int control_read,
                         int status_write, int log_fd, int error_fd) {
    begin_child(parent);
    if (options.netns >= 0 && ::setns(options.netns, CLONE_NEWNET) != 0) {
        give_up(error_fd, "entering its host");
    }
    take_processor(process);
    bool const is_far = process.run_on.kind == RunOn::Kind::ssh || process.run_on.kind == RunOn::Kind::qemu_system;
    bool const speaks = process.has_status || is_far; // far away: the near end of its cable does
    error_fd = arrange_descriptors(options, control_read, speaks ? status_write : -1, log_fd, error_fd);
    for (auto const& [name, value] : process.environment) {
        ::setenv(name.c_str(), value.c_str(), 1);
    }
    ::setenv("SKIP_DEFAULT_XML_FILE", "1", 1); // a stray Fast DDS profile file must not change a run
    ::unsetenv("FASTRTPS_DEFAULT_PROFILES_FILE");
    std::vector<std::string> words = process.command;
    if (process.has_status) {
        words.insert(words.end(), {"--status-fd", std::to_string(kStatusFd)});
    }
    std::vector<char*> arguments;
    for (std::string& word : words) {
        arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    if (process.capabilities) {
        keep_only_capabilities(*process.capabilities);
    }
    std::filesystem::path const folder = process.config_file.parent_path();
    if (::chdir(folder.c_str()) != 0) {
        give_up(error_fd, "entering the run folder");
    }
    execute(arguments);
    give_up(error_fd, arguments[0]);
}

} // namespace

Result<Child> spawn(PlannedProcess const& process, SpawnOptions const& options) {
    std::optional<Pipe> control = make_pipe(), status = make_pipe(), error = make_pipe();
    if (!control || !status || !error) {
        return fail(ExitCode::environment, fmt::format("no pipe for '{}': {}", process.name, std::strerror(errno)));
    }
    UniqueFd log{::open(process.log_file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644)};
    if (!log) {
        return fail(ExitCode::environment,
                    fmt::format("cannot write '{}': {}", process.log_file.string(), std::strerror(errno)));
    }
    pid_t const parent = ::getpid();
    pid_t const pid = ::fork();
    if (pid == 0) {
        become(process, options, parent, control->read.get(), status->write.get(), log.get(), error->write.get());
    }
    if (pid < 0) {
        return fail(ExitCode::environment, fmt::format("cannot start '{}': {}", process.name, std::strerror(errno)));
    }
    error->write.reset(); // the child's alone: its end is the end of what can be read
    char reason[1024];
    ssize_t const size = ::read(error->read.get(), reason, sizeof reason);
    if (size > 0) {
        ::waitpid(pid, nullptr, 0);
        return fail(ExitCode::environment,
                    fmt::format("process '{}' cannot start: {}", process.name,
                                std::string{reason, static_cast<std::size_t>(size)}),
                    process.is_foreign ? "it must be an executable file" : "is Gridspace built completely?");
    }
    Child child;
    child.pid = pid;
    child.pidfd = static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));
    child.status_fd = status->read.release();
    child.control_fd = control->write.release();
    ::fcntl(child.status_fd, F_SETFL, O_NONBLOCK);
    return child;
}

bool is_stopped(pid_t pid) {
    std::ifstream stream{fmt::format("/proc/{}/stat", pid)};
    std::string stat{std::istreambuf_iterator<char>{stream}, {}};
    std::size_t const name_ends = stat.rfind(')'); // proc(5): pid (name) state ...; the name may hold anything
    return name_ends != std::string::npos && name_ends + 2 < stat.size() &&
           (stat[name_ends + 2] == 'T' || stat[name_ends + 2] == 't');
}

std::string describe_end(int wait_status) {
    if (WIFSIGNALED(wait_status)) {
        return fmt::format("killed by signal {} ({})", WTERMSIG(wait_status), ::strsignal(WTERMSIG(wait_status)));
    }
    return fmt::format("exit code {}", WEXITSTATUS(wait_status));
}

} // namespace gridspace::launcher

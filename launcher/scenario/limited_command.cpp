// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/limited_command.hpp"

#include "common/child_process.hpp"
#include "common/unique_fd.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <poll.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

namespace gridspace::launcher {
namespace {

[[noreturn]] void become(pid_t parent, std::vector<std::string>& words, std::filesystem::path const& input, int output,
                         int errors) {
    begin_child(parent);
    ::dup2(::open(input.empty() ? "/dev/null" : input.c_str(), O_RDONLY | O_CLOEXEC), STDIN_FILENO);
    ::dup2(output, STDOUT_FILENO);
    ::dup2(errors, STDERR_FILENO);
    std::vector<char*> arguments;
    for (std::string& word : words) {
        arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    ::execvp(arguments[0], arguments.data());
    std::string const text = fmt::format("{}: {}\n", words.front(), std::strerror(errno));
    [[maybe_unused]] auto const written = ::write(STDERR_FILENO, text.data(), text.size());
    ::_exit(127);
}

/// It computes, or would if it were given a processor; false: it waits for something.
bool wants_to_run(pid_t pid) {
    std::ifstream file{fmt::format("/proc/{}/stat", pid)};
    std::string text;
    std::getline(file, text);
    std::size_t const name = text.rfind(')'); // "pid (name) state ..."
    return name != std::string::npos && name + 2 < text.size() && (text[name + 2] == 'R' || text[name + 2] == 'D');
}

/// Of the limit, as much as the command has used up. On a busy machine it wants to run and may not: that counts little,
/// so that a command which computes for ever still comes to its end.
class UsedTime {
  public:
    std::chrono::milliseconds look(pid_t pid) {
        constexpr int kLittle = 12;
        auto const now = std::chrono::steady_clock::now();
        auto const since = std::chrono::duration_cast<std::chrono::microseconds>(now - std::exchange(last_, now));
        used_ += wants_to_run(pid) ? since / kLittle : since;
        return std::chrono::duration_cast<std::chrono::milliseconds>(used_);
    }

  private:
    std::chrono::steady_clock::time_point last_{std::chrono::steady_clock::now()};
    std::chrono::microseconds used_{};
};

/// The launcher takes signals later; while it prepares a run, they are blocked and wait.
bool asked_to_stop() {
    sigset_t waiting;
    sigpending(&waiting);
    return sigismember(&waiting, SIGINT) == 1 || sigismember(&waiting, SIGTERM) == 1 ||
           sigismember(&waiting, SIGHUP) == 1;
}

} // namespace

Result<CommandResult> run_limited(std::vector<std::string> words, std::chrono::seconds limit,
                                  std::filesystem::path const& input) {
    int output[2], errors[2];
    if (::pipe2(output, O_CLOEXEC) != 0 || ::pipe2(errors, O_CLOEXEC) != 0) {
        return fail(ExitCode::environment, fmt::format("no pipe: {}", std::strerror(errno)));
    }
    pid_t const parent = ::getpid(), pid = ::fork();
    if (pid == 0) {
        become(parent, words, input, output[1], errors[1]);
    }
    ::close(output[1]);
    ::close(errors[1]);
    std::array<UniqueFd, 2> const pipes{UniqueFd{output[0]}, UniqueFd{errors[0]}};
    if (pid < 0) {
        return fail(ExitCode::environment, fmt::format("cannot start '{}': {}", words.front(), std::strerror(errno)));
    }
    CommandResult result;
    std::array<std::string*, 2> const texts{&result.output, &result.errors};
    std::array<bool, 2> open{true, true};
    UsedTime used;
    auto const left_ms = [&] { return (std::chrono::milliseconds{limit} - used.look(pid)).count(); };
    while ((open[0] || open[1]) && !result.too_long) {
        auto const left = left_ms();
        std::array<pollfd, 2> fds{
            {{open[0] ? pipes[0].get() : -1, POLLIN, 0}, {open[1] ? pipes[1].get() : -1, POLLIN, 0}}};
        if (left <= 0) {
            result.timed_out = true;
            break;
        }
        if (asked_to_stop()) {
            ::kill(-pid, SIGKILL);
            ::waitpid(pid, nullptr, 0);
            return fail(ExitCode::interrupted, "stopped");
        }
        ::poll(fds.data(), fds.size(), static_cast<int>(std::min<std::int64_t>(left, 200)));
        for (std::size_t i = 0; i < fds.size(); ++i) {
            std::array<char, 4096> buffer{};
            if (fds.at(i).revents != 0) {
                ssize_t const size = ::read(pipes.at(i).get(), buffer.data(), buffer.size());
                open.at(i) = size > 0;
                texts.at(i)->append(buffer.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
                result.too_long = result.too_long || texts.at(i)->size() > kMaxCommandOutput;
            }
        }
    }
    int status = 0;
    if (!result.timed_out && !result.too_long) { // it has closed its outputs, and may go on nevertheless
        for (pid_t ended = 0; (ended = ::waitpid(pid, &status, WNOHANG)) == 0;) {
            if (left_ms() <= 0) {
                result.timed_out = true;
                break;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
        }
    }
    if (result.timed_out || result.too_long) {
        ::kill(-pid, SIGKILL);
        ::waitpid(pid, &status, 0);
    }
    result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return result;
}

} // namespace gridspace::launcher

// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/unique_fd.hpp"
#include "gateways/cable/ends.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gridspace::cable {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::seconds;

constexpr seconds kStartPatience{20};

std::string json_text(std::string const& text) {
    std::string out;
    for (char const c : text) {
        if (c == '"' || c == '\\') {
            out += '\\';
        }
        out += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
    return out;
}

void write_all(int fd, std::string_view text) {
    while (!text.empty()) {
        ssize_t const size = ::write(fd, text.data(), text.size());
        if (size <= 0) {
            return;
        }
        text.remove_prefix(static_cast<std::size_t>(size));
    }
}

class Near {
  public:
    explicit Near(NearEnd const& options) : options_{options} {}

    int run() {
        sigset_t set;
        sigemptyset(&set);
        sigaddset(&set, SIGTERM);
        sigaddset(&set, SIGINT);
        ::sigprocmask(SIG_BLOCK, &set, &before_);
        std::signal(SIGPIPE, SIG_IGN);
        signals_.reset(::signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK));
        if (auto ok = open_taps(); !ok) {
            return failed("start", ok.error());
        }
        if (auto ok = start_ssh(); !ok) {
            return failed("start", ok.error());
        }
        say_setup();
        while (!code_) {
            step();
        }
        return *code_;
    }

  private:
    Result<void> open_taps() {
        for (std::string const& port : options_.ports) {
            std::size_t const colon = port.rfind(':');
            auto tap = open_tap(port.substr(colon + 1));
            if (!tap) {
                return std::unexpected{tap.error()};
            }
            taps_.emplace_back(*tap);
        }
        return {};
    }

    Result<void> start_ssh() {
        int in[2], out[2], error[2];
        if (::pipe2(in, O_CLOEXEC) != 0 || ::pipe2(out, O_CLOEXEC) != 0 || ::pipe2(error, O_CLOEXEC) != 0) {
            return fail(ExitCode::environment, std::string{"no pipe: "} + std::strerror(errno));
        }
        ssh_ = ::fork();
        if (ssh_ == 0) {
            ::prctl(PR_SET_PDEATHSIG, SIGKILL);
            ::sigprocmask(SIG_SETMASK, &before_, nullptr);
            ::signal(SIGPIPE, SIG_DFL);
            if (!options_.outer_network.empty()) {
                UniqueFd const outer{::open(options_.outer_network.c_str(), O_RDONLY | O_CLOEXEC)};
                if (::setns(outer.get(), CLONE_NEWNET) != 0) {
                    std::perror("the machine's own network");
                    ::_exit(127);
                }
            }
            ::dup2(in[0], STDIN_FILENO);
            ::dup2(out[1], STDOUT_FILENO);
            ::dup2(error[1], STDERR_FILENO);
            ::close(kStatusFd);
            std::vector<char*> words;
            for (std::string const& word : options_.ssh) {
                words.push_back(const_cast<char*>(
                    word.c_str())); // NOLINT(cppcoreguidelines-pro-type-const-cast): execvp's interface
            }
            words.push_back(nullptr);
            ::execvp(words[0], words.data());
            std::perror(words[0]);
            ::_exit(127);
        }
        ::close(in[0]);
        ::close(out[1]);
        ::close(error[1]);
        to_board_.emplace(in[1]);
        from_board_.reset(out[0]);
        errors_.reset(error[0]);
        return {};
    }

    void say_setup() {
        for (std::string const& port : options_.ports) {
            to_board_->send(Kind::port, std::string_view{port}.substr(0, port.rfind(':')));
        }
        std::error_code ignored;
        for (auto const& entry : std::filesystem::directory_iterator{options_.folder, ignored}) {
            std::ifstream file{entry.path(), std::ios::binary};
            std::string text = entry.path().filename().string();
            text += '\0';
            text.append(std::istreambuf_iterator<char>{file}, {});
            to_board_->send(Kind::file, text);
        }
        std::filesystem::remove_all(options_.folder, ignored);
        for (char** variable = ::environ; *variable != nullptr; ++variable) {
            std::string_view const text{*variable};
            if (text.starts_with("GRIDSPACE_") || text.starts_with("SKIP_DEFAULT_XML_FILE=")) {
                to_board_->send(Kind::variable, text);
            }
        }
        for (std::string const& word : options_.program) {
            to_board_->send(Kind::word, word);
        }
        to_board_->send(Kind::go);
    }

    void step() {
        std::vector<pollfd> fds{{from_board_.get(), POLLIN, 0},
                                {signals_.get(), POLLIN, 0},
                                {errors_.get(), POLLIN, 0},
                                {to_board_->empty() ? -1 : to_board_->fd(), POLLOUT, 0}};
        for (UniqueFd const& tap : taps_) {
            fds.push_back({!started_ || to_board_->full() ? -1 : tap.get(), POLLIN, 0});
        }
        ::poll(fds.data(), fds.size(), 500);
        if (fds[2].revents != 0) {
            read_errors();
        }
        if (fds[0].revents != 0 && !read_board()) {
            lost();
            return;
        }
        if (fds[1].revents != 0) {
            signalfd_siginfo info{};
            while (::read(signals_.get(), &info, sizeof info) == sizeof info) {
                to_board_->send(Kind::stop);
                stopping_ = true;
            }
        }
        for (std::size_t i = 0; i < taps_.size(); ++i) {
            if (fds[4 + i].revents != 0) {
                forward_frames(taps_[i].get(), static_cast<std::uint8_t>(i), *to_board_);
            }
        }
        auto const now = Clock::now();
        if (now - said_ > seconds{1}) {
            to_board_->send(Kind::alive);
            said_ = now;
        }
        (void)to_board_->flush(); // its end is noticed on the other pipe
        if (!code_) {
            watch(now);
        }
    }

    void watch(Clock::time_point now) {
        std::chrono::duration<double> const silence = now - heard_;
        if (!started_ && now - begin_ > kStartPatience) {
            code_ = failed("start", {ExitCode::stall,
                                     greeted_ ? "the program does not start within 20 s" : "no answer within 20 s",
                                     "see its log"});
        } else if (started_ && options_.patience_s > 0 && silence.count() > options_.patience_s) {
            code_ = failed("connection", {ExitCode::child_died,
                                          "the connection is lost: nothing has come for " +
                                              std::to_string(static_cast<int>(silence.count())) + " s",
                                          "is the board still on, and its cable in?"});
        }
        if (code_) {
            ::kill(ssh_, SIGKILL);
        }
    }

    void read_errors() {
        std::array<char, 4096> buffer{};
        ssize_t const size = ::read(errors_.get(), buffer.data(), buffer.size());
        if (size <= 0) {
            errors_.reset();
            return;
        }
        std::string_view const text{buffer.data(), static_cast<std::size_t>(size)};
        write_all(STDERR_FILENO, text);
        last_words_ += text;
        last_words_.erase(0, last_words_.size() - std::min<std::size_t>(last_words_.size(), 1000));
    }

    /// False at the end of the stream.
    bool read_board() {
        std::array<char, 65536> buffer{};
        ssize_t const size = ::read(from_board_.get(), buffer.data(), buffer.size());
        if (size <= 0) {
            return size < 0 && (errno == EAGAIN || errno == EINTR);
        }
        heard_ = Clock::now();
        std::string_view text{buffer.data(), static_cast<std::size_t>(size)};
        if (!greeted_) {
            preface_ += text;
            std::size_t const at = preface_.find(kGreeting);
            if (at == std::string::npos) {
                return preface_.size() < 65536;
            }
            greeted_ = true;
            write_all(STDOUT_FILENO, std::string_view{preface_}.substr(0, at)); // of login scripts
            preface_.erase(0, at + kGreeting.size());
            text = preface_;
        }
        stream_.feed(text);
        while (auto const message = stream_.next()) {
            take(*message);
        }
        return !stream_.broken();
    }

    void take(Message const& message) {
        switch (message.kind) {
        case Kind::frame:
            if (message.port < taps_.size()) {
                [[maybe_unused]] auto const written =
                    ::write(taps_[message.port].get(), message.bytes.data(), message.bytes.size());
            }
            break;
        case Kind::started:
            started_ = true;
            break;
        case Kind::log:
            write_all(STDOUT_FILENO, message.bytes);
            break;
        case Kind::status:
            write_all(kStatusFd, message.bytes);
            break;
        case Kind::failed: {
            std::string const text{message.bytes};
            std::size_t const first = text.find('\0'), second = text.find('\0', first + 1);
            if (second != std::string::npos) {
                code_ = failed("start", {static_cast<ExitCode>(std::strtol(text.c_str(), nullptr, 10)),
                                         text.substr(first + 1, second - first - 1), text.substr(second + 1)});
            }
            break;
        }
        case Kind::ended: {
            std::string const text{message.bytes};
            int const number = static_cast<int>(std::strtol(text.c_str() + text.find(' ') + 1, nullptr, 10));
            code_ = text.starts_with("exit")
                        ? number
                        : failed("run", {ExitCode::child_died,
                                         "the program was killed by signal " + std::to_string(number), "see its log"});
            break;
        }
        default:
            break;
        }
    }

    /// The stream ended before the program did.
    void lost() {
        while (errors_.get() >= 0) {
            read_errors();
        }
        int status = 0;
        ::waitpid(ssh_, &status, 0);
        std::string last = last_words_;
        while (!last.empty() && (last.back() == '\n' || last.back() == '\r')) {
            last.pop_back();
        }
        last = last.substr(last.rfind('\n') + 1);
        if (last.empty()) {
            last = WIFEXITED(status) ? "ssh ended with exit code " + std::to_string(WEXITSTATUS(status))
                                     : "ssh was killed";
        }
        if (stopping_) {
            code_ = 0;
        } else if (started_) {
            code_ = failed("connection", {ExitCode::child_died, "the connection is lost: " + last,
                                          "is the board still on, and its cable in?"});
        } else {
            code_ = failed("start", {ExitCode::environment, last, "see its log"});
        }
    }

    /// Informs the launcher, and returns the exit code.
    int failed(std::string const& step, Error const& error) {
        std::string const message = options_.place + " (" + step + "): " + error.message;
        std::fprintf(stderr, "%s%s%s\n", message.c_str(), error.remedy.empty() ? "" : "; ", error.remedy.c_str());
        write_all(kStatusFd, "{\"status\":\"failed\",\"code\":" + std::to_string(static_cast<int>(error.code)) +
                                 ",\"message\":\"" + json_text(message) + "\",\"remedy\":\"" + json_text(error.remedy) +
                                 "\"}\n");
        return static_cast<int>(error.code);
    }

    NearEnd const& options_;
    sigset_t before_{};
    std::vector<UniqueFd> taps_;
    UniqueFd signals_, from_board_, errors_;
    std::optional<Outlet> to_board_;
    pid_t ssh_{-1};
    Stream stream_;
    std::string preface_, last_words_;
    bool greeted_{false}, started_{false}, stopping_{false};
    std::optional<int> code_;
    Clock::time_point begin_{Clock::now()}, heard_{Clock::now()}, said_{};
};

} // namespace

int near_end(NearEnd const& options) {
    return Near{options}.run();
}

} // namespace gridspace::cable

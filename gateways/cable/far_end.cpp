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
#include <poll.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

namespace gridspace::cable {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::seconds;

constexpr seconds kSilence{20}; // of the launcher, which says every second that it is there

std::string error_text() {
    return std::strerror(errno);
}

void write_file(char const* path, std::string const& text) {
    UniqueFd const fd{::open(path, O_WRONLY | O_CLOEXEC)};
    [[maybe_unused]] auto const written = ::write(fd.get(), text.data(), text.size());
}

/// Network, mounts and processes of its own, as an ordinary user in a user namespace.
Result<void> enter_namespaces() {
    bool const root = ::geteuid() == 0;
    uid_t const user = ::geteuid();
    gid_t const group = ::getegid();
    if (::unshare(CLONE_NEWNET | CLONE_NEWNS | CLONE_NEWPID | (root ? 0 : CLONE_NEWUSER)) != 0) {
        return fail(ExitCode::environment, "the board lets this user make no network namespace: " + error_text(),
                    root ? "the capability CAP_SYS_ADMIN is missing"
                         : "log in as root, or allow it (sysctl kernel.unprivileged_userns_clone=1)");
    }
    if (!root) {
        write_file("/proc/self/setgroups", "deny");
        write_file("/proc/self/uid_map", "0 " + std::to_string(user) + " 1");
        write_file("/proc/self/gid_map", "0 " + std::to_string(group) + " 1");
    }
    return {};
}

/// Raw frames are what most programs of a board are for.
Result<void> check_raw_frames() {
    UniqueFd const raw{::socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC, 0)};
    if (raw.get() < 0) {
        return fail(ExitCode::environment, "the board lets this user send no raw frames: " + error_text(),
                    "the capability CAP_NET_RAW is missing");
    }
    return {};
}

struct Setup {
    std::vector<Port> ports;
    std::vector<std::pair<std::string, std::string>> files;
    std::vector<std::string> variables, words;
};

class FarEnd {
  public:
    FarEnd(Stream stream, Setup setup, std::string bundle, std::filesystem::path folder)
        : stream_{std::move(stream)}, setup_{std::move(setup)}, bundle_{std::move(bundle)}, folder_{std::move(folder)} {
    }

    int run() {
        if (auto ok = prepare(); !ok) {
            return give_up(ok.error());
        }
        if (auto ok = start(); !ok) {
            return give_up(ok.error());
        }
        out_.send(Kind::started);
        while (pid_ > 0 || log_.get() >= 0 || status_.get() >= 0) {
            if (!step()) {
                ::kill(-pid_, SIGKILL);
                return static_cast<int>(ExitCode::child_died); // and this namespace with it
            }
        }
        return end();
    }

  private:
    Result<void> prepare() {
        ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr);
        ::mount("proc", "/proc", "proc", MS_NOSUID | MS_NODEV | MS_NOEXEC, nullptr);
        ::mount("gridspace", folder_.c_str(), "tmpfs", MS_NOSUID | MS_NODEV, "mode=0700");
        for (char const* file :
             {"/proc/sys/net/ipv6/conf/all/disable_ipv6", "/proc/sys/net/ipv6/conf/default/disable_ipv6"}) {
            write_file(file, "1"); // frames that nobody asked for
        }
        for (auto const& [name, content] : setup_.files) {
            std::ofstream{folder_ / name, std::ios::binary} << content;
        }
        if (auto ok = configure({"lo", "", ""}); !ok) {
            return ok;
        }
        for (Port const& port : setup_.ports) {
            auto tap = open_tap(port.name);
            if (!tap) {
                return std::unexpected{tap.error()};
            }
            taps_.emplace_back(*tap);
            if (auto ok = configure(port); !ok) {
                return ok;
            }
        }
        return {};
    }

    Result<void> start() {
        int log[2], status[2], error[2];
        if (::pipe2(log, O_CLOEXEC) != 0 || ::pipe2(status, O_CLOEXEC) != 0 || ::pipe2(error, O_CLOEXEC) != 0) {
            return fail(ExitCode::environment, "no pipe: " + error_text());
        }
        std::string const program = bundle_ + "/bin/" + setup_.words.front();
        pid_ = ::fork();
        if (pid_ == 0) {
            become(program, log[1], status[1], error[1]);
        }
        ::close(log[1]);
        ::close(status[1]);
        ::close(error[1]);
        log_.reset(log[0]);
        status_.reset(status[0]);
        UniqueFd const said{error[0]};
        int why = 0;
        if (::read(said.get(), &why, sizeof why) == sizeof why) {
            return fail(ExitCode::environment, "the board cannot start " + program + ": " + std::strerror(why),
                        why == ENOEXEC ? "it is for another processor" : "is the bundle complete?");
        }
        return {};
    }

    [[noreturn]] void become(std::string const& program, int log, int status, int error) {
        ::setpgid(0, 0);
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        int const nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
        log = ::fcntl(log, F_DUPFD_CLOEXEC, 10);
        status = ::fcntl(status, F_DUPFD_CLOEXEC, 10);
        error = ::fcntl(error, F_DUPFD_CLOEXEC, 10);
        ::dup2(nothing, STDIN_FILENO);
        ::dup2(log, STDOUT_FILENO);
        ::dup2(log, STDERR_FILENO);
        ::dup2(status, kStatusFd);
        for (std::string& variable : setup_.variables) {
            ::putenv(variable.data());
        }
        ::setenv("LD_LIBRARY_PATH", (bundle_ + "/lib").c_str(), 1);
        std::vector<char*> words;
        for (std::string& word : setup_.words) {
            words.push_back(word.data());
        }
        words.push_back(nullptr);
        int why = 0;
        if (::chdir(folder_.c_str()) != 0 || ::execv(program.c_str(), words.data()) != 0) {
            why = errno;
        }
        [[maybe_unused]] auto const written = ::write(error, &why, sizeof why);
        ::_exit(127);
    }

    /// False when the launcher is gone.
    bool step() {
        std::vector<pollfd> fds{{STDIN_FILENO, POLLIN, 0},
                                {log_.get(), POLLIN, 0},
                                {status_.get(), POLLIN, 0},
                                {out_.empty() ? -1 : out_.fd(), POLLOUT, 0}};
        for (UniqueFd const& tap : taps_) {
            fds.push_back({out_.full() ? -1 : tap.get(), POLLIN, 0});
        }
        ::poll(fds.data(), fds.size(), 500);
        if (fds[0].revents != 0 && !take_input()) {
            return false;
        }
        auto const now = Clock::now();
        if (now - heard_ > kSilence) {
            return false;
        }
        if (now - said_ > seconds{1}) {
            out_.send(Kind::alive);
            said_ = now;
        }
        if (fds[1].revents != 0) {
            pass_on(log_, Kind::log);
        }
        if (fds[2].revents != 0) {
            pass_on(status_, Kind::status);
        }
        for (std::size_t i = 0; i < taps_.size(); ++i) {
            if (fds[4 + i].revents != 0) {
                forward_frames(taps_[i].get(), static_cast<std::uint8_t>(i), out_);
            }
        }
        for (int status = 0; pid_ > 0;) { // process 1 buries everybody
            pid_t const who = ::waitpid(-1, &status, WNOHANG);
            if (who <= 0) {
                break;
            }
            if (who == pid_) {
                pid_ = -1;
                end_ = status;
            }
        }
        return out_.flush();
    }

    bool take_input() {
        std::array<char, 65536> buffer{};
        ssize_t const size = ::read(STDIN_FILENO, buffer.data(), buffer.size());
        if (size <= 0) {
            return size < 0 && (errno == EAGAIN || errno == EINTR);
        }
        heard_ = Clock::now();
        stream_.feed({buffer.data(), static_cast<std::size_t>(size)});
        while (auto const message = stream_.next()) {
            if (message->kind == Kind::frame && message->port < taps_.size()) {
                [[maybe_unused]] auto const written =
                    ::write(taps_[message->port].get(), message->bytes.data(), message->bytes.size());
            } else if (message->kind == Kind::stop && pid_ > 0) {
                ::kill(-pid_, SIGTERM);
            }
        }
        return !stream_.broken();
    }

    void pass_on(UniqueFd& from, Kind kind) {
        std::array<char, 4096> buffer{};
        ssize_t const size = ::read(from.get(), buffer.data(), buffer.size());
        if (size <= 0) {
            from.reset();
            return;
        }
        std::string_view const text{buffer.data(), static_cast<std::size_t>(size)};
        out_.send(kind, text);
        if (kind == Kind::log) {
            printed_ += text;
            printed_.erase(0, printed_.size() - std::min<std::size_t>(printed_.size(), 2000));
        }
    }

    int end() {
        bool const exited = WIFEXITED(end_);
        int const code = exited ? WEXITSTATUS(end_) : WTERMSIG(end_);
        constexpr std::string_view kLoader = "error while loading shared libraries: ";
        std::size_t const at = printed_.find(kLoader);
        if (exited && code == 127 && at != std::string::npos) {
            std::size_t const begin = at + kLoader.size();
            return give_up({ExitCode::environment,
                            "the board lacks a library: " + printed_.substr(begin, printed_.find('\n', begin) - begin),
                            "install it there, or delete " + bundle_ + " there, so that it is copied again"});
        }
        out_.send(Kind::ended, (exited ? "exit " : "signal ") + std::to_string(code));
        drain();
        return exited ? code : static_cast<int>(ExitCode::child_died);
    }

    int give_up(Error const& error) {
        std::string text = std::to_string(static_cast<int>(error.code));
        text += '\0' + error.message + '\0' + error.remedy;
        out_.send(Kind::failed, text);
        drain();
        return static_cast<int>(error.code);
    }

    void drain() {
        auto const until = Clock::now() + seconds{5};
        while (out_.flush() && !out_.empty() && Clock::now() < until) {
            pollfd ready{out_.fd(), POLLOUT, 0};
            ::poll(&ready, 1, 500);
        }
    }

    Stream stream_;
    Setup setup_;
    std::string bundle_;
    std::filesystem::path folder_;
    std::vector<UniqueFd> taps_;
    UniqueFd log_, status_;
    Outlet out_{STDOUT_FILENO};
    std::string printed_; // the end of it
    pid_t pid_{-1};
    int end_{0};
    Clock::time_point heard_{Clock::now()}, said_{};
};

/// Everything until "go"; false when the other end is gone, or says nonsense.
bool read_setup(Stream& stream, Setup& setup) {
    std::array<char, 65536> buffer{};
    while (true) {
        pollfd ready{STDIN_FILENO, POLLIN, 0};
        if (::poll(&ready, 1, std::chrono::milliseconds{kSilence}.count()) <= 0) {
            return false;
        }
        ssize_t const size = ::read(STDIN_FILENO, buffer.data(), buffer.size());
        if (size <= 0) {
            return false;
        }
        stream.feed({buffer.data(), static_cast<std::size_t>(size)});
        while (auto const message = stream.next()) {
            std::string const text{message->bytes};
            switch (message->kind) {
            case Kind::go:
                return !setup.words.empty();
            case Kind::port:
                if (auto port = parse_port(text)) {
                    setup.ports.push_back(std::move(*port));
                }
                break;
            case Kind::file: {
                std::size_t const end = std::min(text.find('\0'), text.size() - 1);
                if (text.find('/') >= end) { // a name, no path
                    setup.files.emplace_back(text.substr(0, end), text.substr(end + 1));
                }
                break;
            }
            case Kind::variable:
                setup.variables.push_back(text);
                break;
            case Kind::word:
                setup.words.push_back(text);
                break;
            default:
                break;
            }
        }
        if (stream.broken()) {
            return false;
        }
    }
}

int print(Error const& error) {
    std::fprintf(stderr, "%s\n", describe(error).c_str());
    return static_cast<int>(error.code);
}

} // namespace

int far_end(std::string const& bundle) {
    std::signal(SIGPIPE, SIG_IGN);
    [[maybe_unused]] auto const greeted = ::write(STDOUT_FILENO, kGreeting.data(), kGreeting.size());
    Stream stream;
    Setup setup;
    if (!read_setup(stream, setup)) {
        return print(
            {ExitCode::usage, "standard input does not say what to start", "this is started by `gridspace run`"});
    }
    std::array<char, 32> folder{"/tmp/gridspace-XXXXXX"};
    if (::mkdtemp(folder.data()) == nullptr) {
        return print({ExitCode::environment, "cannot write into /tmp of the board: " + error_text(), ""});
    }
    int code = static_cast<int>(ExitCode::environment);
    if (auto ok = enter_namespaces(); !ok) {
        code = print(ok.error());
    } else {
        pid_t const pid = ::fork(); // process 1 of the namespaces
        if (pid == 0) {
            ::prctl(PR_SET_PDEATHSIG, SIGKILL);
            ::_exit(FarEnd{std::move(stream), std::move(setup), bundle, folder.data()}.run());
        }
        int status = 0;
        ::waitpid(pid, &status, 0);
        code = WIFEXITED(status) ? WEXITSTATUS(status) : static_cast<int>(ExitCode::child_died);
    }
    ::umount2(folder.data(), MNT_DETACH); // a mount point, of these namespaces, is busy
    if (::rmdir(folder.data()) != 0) {
        std::fprintf(stderr, "the folder %s stays on the board: %s\n", folder.data(), error_text().c_str());
    }
    return code;
}

int check_far_end() {
    if (auto ok = enter_namespaces(); !ok) {
        return print(ok.error());
    }
    if (auto tap = open_tap("probe"); !tap) {
        return print(tap.error());
    }
    if (auto ok = check_raw_frames(); !ok) {
        return print(ok.error());
    }
    return 0;
}

} // namespace gridspace::cable
